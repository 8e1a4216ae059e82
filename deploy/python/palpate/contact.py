"""Contact of a tool with a body, and safe forces for a haptic device."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from ctypes import POINTER, byref, c_double, c_float, c_void_p
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _library
from ._library import ByValue, Numbers
from .dataset import Dataset, position
from .live import Live

if TYPE_CHECKING:
    import numpy.typing as npt

_guards = ("ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late", "beyond")


class ContactMode(enum.IntEnum):
    """The kind of contact."""

    UNILATERAL = 0  #: the tissue pushes the tool away and never pulls
    GLUED = 1  #: the tool sticks to the surface, and can also pull it


@dataclass
class ContactOptions:
    """Options of a contact. Start from ``Contact.defaults`` of a dataset."""

    mode: ContactMode
    friction: float  #: Coulomb friction coefficient, for unilateral contact
    grab_distance: float  #: m; glued contact: distance at which the tool sticks to the surface
    most_slide: float  #: m; longest slide of the point of contact per update
    most_relaxation: float  #: largest relative change of the force per update by sliding, besides that by the tool's motion


@dataclass(frozen=True, eq=False)
class Touch(ByValue):
    """State of a contact after one position of the tool."""

    touching: bool
    stepped: bool  #: the force may have jumped by more than the motion explains
    inside: bool  #: as in ``Answers``, for all spaces involved; False also if the position was not finite
    triangle: int  #: touched triangle; -1: none
    force: Numbers  #: (3,), N, on the tool; zero without contact
    stiffness: Numbers  #: (3, 3), N/m: d force / d tool, with the point of contact held
    energy: float  #: J, stored in the tissue; NaN: method without energy
    error_bound: float  #: N; NaN: unknown
    coverage: float  #: 0 to 1
    barycentric: Numbers  #: (3,), point of contact in the triangle
    anchor: Numbers  #: (3,), m, the point of contact at rest
    normal: Numbers  #: (3,), unit outward normal of the surface at rest, at the anchor
    displacement: Numbers  #: (3,), m: tool - anchor
    gap: float  #: m, without contact: distance to the body, negative inside
    beyond: float  #: m, length of the displacement beyond the computed data, where an extrapolated force pushes back; 0: inside
    drive: Numbers  #: (3,), N, as in ``Answers``; zero outside of areas
    _given: _library.Touch  #: for ``Contact.shape``


def _touch(given: _library.Touch) -> Touch:
    return Touch(touching=bool(given.touching), stepped=bool(given.stepped), inside=bool(given.inside), triangle=given.triangle,
                 force=np.array(given.force), stiffness=np.array(given.stiffness).reshape(3, 3), energy=given.energy,
                 error_bound=given.error_bound, coverage=given.coverage, barycentric=np.array(given.barycentric),
                 anchor=np.array(given.anchor), normal=np.array(given.normal), displacement=np.array(given.displacement),
                 gap=given.gap, beyond=given.beyond, drive=np.array(given.drive), _given=given)


def _options(dataset: Dataset, options: ContactOptions | None, method: str | int) -> _library.ContactOptions:
    given = _library.ContactOptions()
    _library.call("contact_defaults", dataset.handle, byref(given))
    if options is not None:
        for field in fields(options):
            setattr(given, field.name, getattr(options, field.name))
    given.method = dataset._method(method)
    return given


def _shape(dataset: Any, vertices: tuple[int, ...], touch: Touch) -> npt.NDArray[np.float32]:
    shape = np.empty(vertices, np.float32)
    _library.call("touch_displacements", dataset, byref(touch._given), shape.ctypes.data_as(POINTER(c_float)), shape.size)
    return shape


class Contact(_library.Handle):
    """A point tool on a dataset's body. It touches where it crosses the surface from outside, slides with friction, and lets go.

    Its force depends on the path, so pass every position in order, the first outside the body. One thread at a time. Keeps its
    dataset in memory.
    """

    _destroy = "contact_destroy"

    def __init__(self, dataset: Dataset, options: ContactOptions | None = None, method: str | int = 0,
                 live: Live | None = None) -> None:
        """options: default ``Contact.defaults(dataset)``. method: name or index of a prepared method. live: a live solver of
        ``dataset`` (``Live.dataset``) that corrects the forces of one contact at a time."""
        given = _options(dataset, options, method)
        if live is not None:
            given.live = live.handle._as_parameter_
        handle = c_void_p()
        _library.call("contact_create", dataset.handle, byref(given), byref(handle))
        self._own(handle)
        self._dataset, self._vertices = dataset.handle, dataset.vertices.shape

    @staticmethod
    def defaults(dataset: Dataset) -> ContactOptions:
        """Returns the options that the scene of a dataset sets."""
        given = _library.ContactOptions()
        _library.call("contact_defaults", dataset.handle, byref(given))
        return ContactOptions(ContactMode(given.mode), given.friction, given.grab_distance, given.most_slide,
                              given.most_relaxation)

    def update(self, tool: npt.ArrayLike, hold: bool = True) -> Touch:
        """Moves the tool to ``tool``, (3,), m, and returns the touch. hold: for glued contact; False lets go. A position that is
        not finite ends the contact."""
        given = _library.Touch()
        _library.call("contact_update", self.handle, position(tool), int(hold), byref(given))
        return _touch(given)

    def follow(self, tools: Iterable[npt.ArrayLike], hold: bool = True) -> list[Touch]:
        """Calls ``update`` for each position in order."""
        return [self.update(tool, hold) for tool in tools]

    def shape(self, touch: Touch) -> npt.NDArray[np.float32]:
        """Returns the displacements of ``Dataset.vertices`` in a touch of this contact, (V, 3), m."""
        return _shape(self._dataset, self._vertices, touch)

    def release(self) -> None:
        """Ends the contact; the tool must come from outside again."""
        _library.call("contact_release", self.handle)

    def use(self, dataset: Dataset, method: str | int = 0) -> None:
        """Switches to another dataset or method. Keeps the contact if both surfaces have the same triangles."""
        _library.call("contact_use", self.handle, dataset.handle, dataset._method(method))
        self._dataset, self._vertices = dataset.handle, dataset.vertices.shape


@dataclass(frozen=True)
class DeviceProfile:
    """Limits of a haptic device."""

    name: str
    max_force: float  #: N
    max_stiffness: float  #: N/m, largest stiffness that the closed loop renders stably
    workspace_radius: float  #: m


def device(name: str) -> DeviceProfile:
    """Returns a profile by name: "touch", "omni", "falcon", "omega", ... For an unknown name, the error lists all names."""
    given = _library.Profile()
    _library.call("device_profile", name.encode(), byref(given))
    return DeviceProfile(given.name.decode(), given.max_force, given.max_stiffness, given.workspace_radius)


@dataclass
class GuardOptions:
    """Limits of a guard. Start from ``Guard.defaults`` of a device."""

    period: float  #: s, loop period
    max_force: float  #: N
    max_slew: float  #: N/s; 0: the force can reach max_force in 10 ms
    ramp: float  #: s, time to fade in a jump of the force
    stall: float  #: s, time without a fresh reading after which the force goes to zero
    max_stiffness: float  #: N/m, of the device; has no effect at present
    energy_credit: float  #: J, largest surplus or deficit of energy that is carried along
    delay: float = 0.0  #: s, from the reading of a position until its force acts; 0: within the period


@dataclass(frozen=True, eq=False)
class GuardedForce(ByValue):
    """A force that is safe for a device."""

    force: Numbers  #: (3,), N, finite, at most max_force long
    passivity: float  #: J, work of the hand minus energy stored in the tissue; negative: the loop created energy
    guards: tuple[str, ...]  #: active limits: "ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late", "beyond"


class Guard(_library.Handle):
    """Makes the force of a contact safe for a device: limits its length and rate, fades in jumps, keeps the loop passive.

    Python is not a real-time language: write a 1 kHz loop for a real hand in C. One thread at a time.
    """

    _destroy = "guard_destroy"

    def __init__(self, options: GuardOptions | None = None) -> None:
        """options: default ``Guard.defaults()``."""
        given = _library.GuardOptions()
        _library.call("guard_defaults", None, 0.001, byref(given))
        if options is not None:
            for field in fields(options):
                setattr(given, field.name, getattr(options, field.name))
        handle = c_void_p()
        _library.call("guard_create", byref(given), byref(handle))
        self._own(handle)

    @staticmethod
    def defaults(device: str | None = None, period: float = 0.001) -> GuardOptions:
        """Returns the limits for a device by name and a loop period, s. Without a name, those of the weakest device."""
        given = _library.GuardOptions()
        _library.call("guard_defaults", device.encode() if device else None, period, byref(given))
        return GuardOptions(*(getattr(given, field.name) for field in fields(GuardOptions)))

    def limit(self, tool: npt.ArrayLike, touch: Touch, fresh: bool = True, lost: bool = False,
              late: bool = False) -> GuardedForce:
        """Returns the force to send. Call once per period, even without contact; if it raises, send zero.

        tool: (3,), m, the position of the touch. touch: unchanged, or ``dataclasses.replace(touch, force=..., touching=True)``
        to add forces of your own. fresh: the position is new. lost: the device is gone. late: the loop hung before this call.
        """
        given = _library.GuardedForce()
        flags = bool(fresh) | bool(lost) << 1 | bool(late) << 2
        limited = _library.Touch(touching=touch.touching, stepped=touch.stepped, energy=touch.energy,
                                 force=_library.Vector(*touch.force), stiffness=_library.Matrix(*np.ravel(touch.stiffness)))
        _library.call("guard_limit", self.handle, position(tool), byref(limited), flags, byref(given))
        words = tuple(word for bit, word in enumerate(_guards) if given.guards >> bit & 1)
        return GuardedForce(np.array(given.force), given.passivity, words)

    def reset(self) -> None:
        """Resets the guard to its initial state."""
        _library.call("guard_reset", self.handle)
