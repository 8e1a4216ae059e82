"""Contact of a tool with a body, and what a haptic device may be given of its force."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from ctypes import POINTER, byref, c_double, c_float, c_void_p
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _library
from ._library import ByValue, Numbers
from .dataset import Dataset

_guards = ("ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late", "beyond")


class ContactMode(enum.IntEnum):
    """How a tool holds a body."""

    UNILATERAL = 0  #: the tissue pushes the tool away and never pulls
    GLUED = 1  #: the tool sticks to the surface, and can also pull it


@dataclass
class ContactOptions:
    """How a tool touches. Change what ``Contact.defaults`` gives for a dataset."""

    mode: ContactMode
    friction: float  #: Coulomb friction coefficient, for unilateral contact
    grab_distance: float  #: m; glued contact: distance at which the tool sticks to the surface
    most_slide: float  #: m; longest slide of the point of contact per update
    most_relaxation: float  #: largest relative change of the force by sliding per update, beyond that by the tool's motion


@dataclass(frozen=True, eq=False)
class Touch(ByValue):
    """What the tissue does to the tool, after one position."""

    touching: bool
    stepped: bool  #: the force may have jumped, more than the motion explains
    inside: bool  #: as in ``Answers``, for all spaces involved
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
    beyond: float  #: m, along the displacement, beyond the computed data, where a continuation pushes back; 0: inside
    _given: _library.Touch  #: for ``Contact.shape``


def _touch(given: _library.Touch) -> Touch:
    return Touch(touching=bool(given.touching), stepped=bool(given.stepped), inside=bool(given.inside), triangle=given.triangle,
                 force=np.array(given.force), stiffness=np.array(given.stiffness).reshape(3, 3), energy=given.energy,
                 error_bound=given.error_bound, coverage=given.coverage, barycentric=np.array(given.barycentric),
                 anchor=np.array(given.anchor), normal=np.array(given.normal), displacement=np.array(given.displacement),
                 gap=given.gap, beyond=given.beyond, _given=given)


def _position(tool: npt.ArrayLike) -> Any:
    values = np.ascontiguousarray(tool, np.float64)
    if values.shape != (3,):
        raise ValueError(f"a position has shape {values.shape}; x, y and z are wanted, (3,)")
    return values.ctypes.data_as(POINTER(c_double))


class Contact(_library.Handle):
    """A point tool on a dataset's body: it touches where it crosses the surface from outside, slides with friction, lets go.

    What it feels depends on the way it took, so give it every position in turn, the first outside of the body. One thread at a
    time. It keeps its dataset in memory.
    """

    _destroy = "contact_destroy"

    def __init__(self, dataset: Dataset, options: ContactOptions | None = None, method: str | int = 0) -> None:
        """options: ``Contact.defaults(dataset)`` when there are none. method: name or number of a prepared one."""
        given = _library.ContactOptions()
        _library.call("contact_defaults", dataset.handle, byref(given))
        if options is not None:
            for field in fields(options):
                setattr(given, field.name, getattr(options, field.name))
        given.method = dataset._method(method)
        handle = c_void_p()
        _library.call("contact_create", dataset.handle, byref(given), byref(handle))
        self._own(handle)
        self._dataset, self._vertices = dataset.handle, dataset.vertices.shape

    @staticmethod
    def defaults(dataset: Dataset) -> ContactOptions:
        """The options that the scene of a dataset asks for."""
        given = _library.ContactOptions()
        _library.call("contact_defaults", dataset.handle, byref(given))
        return ContactOptions(ContactMode(given.mode), given.friction, given.grab_distance, given.most_slide,
                              given.most_relaxation)

    def update(self, tool: npt.ArrayLike, hold: bool = True) -> Touch:
        """The touch with the tool at ``tool``, (3,), m. hold: glued only, False lets go. Not finite: contact ends."""
        given = _library.Touch()
        _library.call("contact_update", self.handle, _position(tool), int(hold), byref(given))
        return _touch(given)

    def follow(self, tools: Iterable[npt.ArrayLike], hold: bool = True) -> list[Touch]:
        """``update`` for one position after the other."""
        return [self.update(tool, hold) for tool in tools]

    def shape(self, touch: Touch) -> npt.NDArray[np.float32]:
        """(V, 3), m: displacements of ``Dataset.vertices`` in a touch of this contact."""
        shape = np.empty(self._vertices, np.float32)
        _library.call("touch_displacements", self._dataset, byref(touch._given), shape.ctypes.data_as(POINTER(c_float)),
                      shape.size)
        return shape

    def release(self) -> None:
        """Ends the contact; the tool must come from outside again."""
        _library.call("contact_release", self.handle)

    def use(self, dataset: Dataset, method: str | int = 0) -> None:
        """Goes on with another dataset or method. Contact is kept where both surfaces have the same triangles."""
        _library.call("contact_use", self.handle, dataset.handle, dataset._method(method))
        self._dataset, self._vertices = dataset.handle, dataset.vertices.shape


@dataclass(frozen=True)
class DeviceProfile:
    """What a haptic device can do."""

    name: str
    max_force: float  #: N
    max_stiffness: float  #: N/m, largest that the closed loop renders stably
    workspace_radius: float  #: m


def device(name: str) -> DeviceProfile:
    """By name: "touch", "omni", "falcon", "omega", ...; the error for another lists all."""
    given = _library.Profile()
    _library.call("device_profile", name.encode(), byref(given))
    return DeviceProfile(given.name.decode(), given.max_force, given.max_stiffness, given.workspace_radius)


@dataclass
class GuardOptions:
    """Limits. Change what ``Guard.defaults`` gives for a device."""

    period: float  #: s, loop period
    max_force: float  #: N
    max_slew: float  #: N/s; 0: max_force in 10 ms
    ramp: float  #: s, time to fade in a jump of the force
    stall: float  #: s, time without a fresh reading after which the force goes to zero
    max_stiffness: float  #: N/m, of the device; has no effect any more
    energy_credit: float  #: J, largest credit for dissipated energy
    delay: float = 0.0  #: s, from a position to its force, beyond the period


@dataclass(frozen=True, eq=False)
class GuardedForce(ByValue):
    """A force that a device may be given."""

    force: Numbers  #: (3,), N, finite, at most max_force long
    passivity: float  #: J, work of the hand minus energy stored in the tissue; negative: the loop created energy
    guards: tuple[str, ...]  #: active limits: "ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late", "beyond"


class Guard(_library.Handle):
    """Stands between the force of a contact and a device: limits length and rate, fades steps in, keeps the loop passive.

    Python is no real-time language: a loop at 1 kHz that a hand feels belongs into C. One thread at a time.
    """

    _destroy = "guard_destroy"

    def __init__(self, options: GuardOptions | None = None) -> None:
        """options: ``Guard.defaults()`` when there are none."""
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
        """For a device by name, and a loop of this period, s; without a name for the smallest."""
        given = _library.GuardOptions()
        _library.call("guard_defaults", device.encode() if device else None, period, byref(given))
        return GuardOptions(*(getattr(given, field.name) for field in fields(GuardOptions)))

    def limit(self, tool: npt.ArrayLike, touch: Touch, fresh: bool = True, lost: bool = False,
              late: bool = False) -> GuardedForce:
        """The force to send, once per period, also while nothing is touched. Should this raise, send zero.

        tool: (3,), m, that the touch is of. touch: as it is, or ``dataclasses.replace(touch, force=..., touching=True)`` with
        forces of yours. fresh: the position is new. lost: the device is gone. late: the loop hung before.
        """
        given = _library.GuardedForce()
        flags = bool(fresh) | bool(lost) << 1 | bool(late) << 2
        limited = _library.Touch(touching=touch.touching, stepped=touch.stepped, energy=touch.energy,
                                 force=_library.Vector(*touch.force), stiffness=_library.Matrix(*np.ravel(touch.stiffness)))
        _library.call("guard_limit", self.handle, _position(tool), byref(limited), flags, byref(given))
        words = tuple(word for bit, word in enumerate(_guards) if given.guards >> bit & 1)
        return GuardedForce(np.array(given.force), given.passivity, words)

    def reset(self) -> None:
        """Forgets the past: as new."""
        _library.call("guard_reset", self.handle)
