"""Many contacts at once, for simulators that run many environments."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_uint8, c_void_p
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _library
from ._library import ByValue, Numbers
from .contact import ContactOptions, Touch, _options, _shape, _touch
from .dataset import Dataset, arrays_for

if TYPE_CHECKING:
    import numpy.typing as npt

    from .live import Live


@dataclass(frozen=True, eq=False)
class Touches(ByValue):
    """State of n contacts after one position of each tool. Row i has the values of ``Touch`` for contact i."""

    touching: npt.NDArray[np.bool_]  #: (n,)
    stepped: npt.NDArray[np.bool_]  #: (n,)
    inside: npt.NDArray[np.bool_]  #: (n,)
    triangle: npt.NDArray[np.int32]  #: (n,)
    force: Numbers  #: (n, 3), N, on the tool; zero without contact
    stiffness: Numbers  #: (n, 3, 3), N/m
    energy: Numbers  #: (n,), J
    error_bound: Numbers  #: (n,), N
    coverage: Numbers  #: (n,)
    anchor: Numbers  #: (n, 3), m
    normal: Numbers  #: (n, 3)
    displacement: Numbers  #: (n, 3), m
    gap: Numbers  #: (n,), m
    beyond: Numbers  #: (n,), m
    drive: Numbers  #: (n, 3), N


# The member of palpate_touches, the name, shape and type of an array.
_arrays: dict[str, tuple[str, tuple[int, ...], Any]] = {
    "touching": ("touching", (), np.bool_), "stepped": ("stepped", (), np.bool_), "inside": ("inside", (), np.bool_),
    "triangles": ("triangle", (), np.int32), "forces": ("force", (3,), np.float64), "stiffnesses": ("stiffness", (3, 3), np.float64),
    "energies": ("energy", (), np.float64), "error_bounds": ("error_bound", (), np.float64),
    "coverages": ("coverage", (), np.float64), "anchors": ("anchor", (3,), np.float64), "normals": ("normal", (3,), np.float64),
    "displacements": ("displacement", (3,), np.float64), "gaps": ("gap", (), np.float64), "beyond": ("beyond", (), np.float64),
    "drives": ("drive", (3,), np.float64)}


class Contacts(_library.Handle):
    """``count`` independent contacts on a dataset's body, updated by one call on arrays.

    Each contact has its own place, history and friction, and gives the forces of a single ``Contact``, to the last bit, whatever
    ``count`` and ``threads``. One Python thread at a time. Keeps its dataset in memory.
    """

    _destroy = "contacts_destroy"

    def __init__(self, dataset: Dataset, count: int, options: ContactOptions | None = None, method: str | int = 0,
                 threads: int = 0) -> None:
        """options, method: as of ``Contact``, the same for all. threads: used by ``update``; 0: one per core."""
        given = _options(dataset, options, method)
        handle = c_void_p()
        _library.call("contacts_create", dataset.handle, byref(given), count, threads, byref(handle))
        self._own(handle)
        self._count, self._dataset, self._vertices = count, dataset.handle, dataset.vertices.shape

    def __len__(self) -> int:
        return self._count

    def follow(self, index: int, live: Live | None) -> None:
        """Lets a live solver of this dataset follow one contact, whose touch ends; None: none.

        A live solver follows one contact at a time, and takes a core. Call ``update`` every ``period`` seconds then.
        """
        _library.call("contacts_follow", self.handle, index, None if live is None else live.handle)

    def set_friction(self, friction: npt.ArrayLike) -> None:
        """Sets the Coulomb friction coefficients for later updates: one, or one per contact, (n,)."""
        given = np.ascontiguousarray(np.broadcast_to(np.asarray(friction, np.float64), (self._count,)))
        _library.call("contacts_set_frictions", self.handle, given.ctypes.data_as(POINTER(c_double)))

    def update(self, tools: npt.ArrayLike, hold: npt.ArrayLike = True, out: Touches | None = None) -> Touches:
        """Moves the tools to ``tools``, (n, 3), m, and returns the touches.

        hold: for glued contact, one or (n,); False lets go. A position that is not finite ends its contact, whose force is then
        zero and ``inside`` False; the others go on.
        out: touches of an earlier call, to overwrite without allocation.
        """
        positions = np.ascontiguousarray(tools, np.float64)
        if positions.shape != (self._count, 3):
            raise ValueError(f"tools have shape {positions.shape}; they must be x, y and z of each, ({self._count}, 3)")
        arrays = arrays_for((self._count,), tuple(_arrays.values()), out)
        given = _library.Touches(**{member: arrays[name].ctypes.data for member, (name, _, _) in _arrays.items()})
        _library.call("contacts_update", self.handle, positions.ctypes.data_as(POINTER(c_double)),
                      None if hold is True else self._mask(hold), byref(given))
        return Touches(**arrays) if out is None else out

    def touch(self, index: int) -> Touch:
        """Returns the touch of one contact after the last update, for ``shape`` and ``Guard.limit``."""
        given = _library.Touch()
        _library.call("contacts_touch", self.handle, index, byref(given))
        return _touch(given)

    def shape(self, touch: Touch) -> npt.NDArray[np.float32]:
        """Returns the displacements of ``Dataset.vertices`` in a touch of these contacts, (V, 3), m."""
        return _shape(self._dataset, self._vertices, touch)

    def release(self, which: npt.ArrayLike = True) -> None:
        """Ends contacts, for environments that start again: all, or those where ``which``, (n,), is True. Their tools may then be
        anywhere, and touch when they come from outside again."""
        _library.call("contacts_release", self.handle, self._mask(which))

    def _mask(self, values: npt.ArrayLike) -> Any:
        mask = np.ascontiguousarray(np.broadcast_to(np.asarray(values, np.bool_), (self._count,)))
        return mask.ctypes.data_as(POINTER(c_uint8))
