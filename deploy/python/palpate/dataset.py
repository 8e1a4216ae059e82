"""Datasets in memory, and batched queries."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator, Sequence
from ctypes import POINTER, byref, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint8, c_void_p
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _library
from ._library import ByValue, Numbers

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class SpaceInfo(ByValue):
    """One active node and its configuration space."""

    name: str  #: name of the active node in the scene
    node: int  #: index in the mesh
    vertex: int  #: index in ``Dataset.vertices``
    rest_position: Numbers  #: (3,), m; for a finger, its centre
    workspace_radius: float  #: m: displacements up to this long were solved
    spacing: float  #: m, between lattice points before refinement
    largest_force: float  #: N, largest solved force


@dataclass(frozen=True)
class AreaInfo:
    """A surface that a finger of finite size touches anywhere."""

    name: str  #: name in the scene
    finger_radius: float  #: m
    workspace_radius: float  #: m: displacements up to this long were solved
    site_count: int  #: number of solved finger sites


@dataclass(frozen=True, eq=False)
class Answers(ByValue):
    """Answers for displacements. ``...`` is the shape of the query: () for one displacement, (n,) for n."""

    force: Numbers  #: (..., 3), N, on the tool; always finite
    stiffness: Numbers  #: (..., 3, 3), N/m: [i, j] = d force[i] / d displacement[j], exact for this method
    energy: Numbers  #: (...), J, stored in the tissue; NaN: method without energy
    error_bound: Numbers  #: (...), N, of the force; estimated to hold at 99 % of places; NaN: unknown
    coverage: Numbers  #: (...), 0 to 1: share of the answer that is based on solved equilibria of one branch
    inside: npt.NDArray[np.bool_]  #: (...): False beyond the computed data, where a wall pushes back, or away from the area
    drive: Numbers | None = None  #: fingers only: (..., 3), N, configurational force -dE/ds along the surface, which drives sliding
    at: Numbers | None = None  #: fingers only: (..., 3), m, the nearest place on the surface at rest, to which the answer applies
    triangle: npt.NDArray[np.int32] | None = None  #: fingers only: (...), triangle of ``at``; -1: not finite
    distance: Numbers | None = None  #: fingers only: (...), m, from the requested place to ``at``; if far, ``inside`` is False


_of_all = ("force", (3,), np.float64), ("stiffness", (3, 3), np.float64), ("energy", (), np.float64), (
    "error_bound", (), np.float64), ("coverage", (), np.float64), ("inside", (), np.bool_)
_of_areas = ("drive", (3,), np.float64), ("at", (3,), np.float64), ("triangle", (), np.int32), ("distance", (), np.float64)
_members = {"force": "forces", "stiffness": "stiffnesses", "energy": "energies", "error_bound": "error_bounds",
            "coverage": "coverages", "inside": "inside", "drive": "drives", "at": "places", "triangle": "triangles",
            "distance": "distances"}


def _vectors(values: npt.ArrayLike, what: str) -> Numbers:
    """Converts to the layout that libpalpate reads: float64, C-contiguous, last axis of length 3."""
    vectors = np.ascontiguousarray(values, dtype=np.float64)
    if vectors.ndim == 0 or vectors.shape[-1] != 3:
        raise ValueError(f"{what} has shape {vectors.shape}; the last axis must have x, y and z (3)")
    return vectors


def _doubles(array: Numbers) -> Any:
    return array.ctypes.data_as(POINTER(c_double))


def position(tool: npt.ArrayLike) -> Any:
    """Converts x, y and z for libpalpate."""
    values = np.ascontiguousarray(tool, np.float64)
    if values.shape != (3,):
        raise ValueError(f"a position or displacement has shape {values.shape}; it must be x, y and z, (3,)")
    return values.ctypes.data_as(POINTER(c_double))


@contextlib.contextmanager
def hdf5_alone() -> Iterator[None]:
    """Locks h5py, if it is loaded, while libpalpate reads a file: HDF5 is not thread-safe."""
    # Copy the list, because another thread may import meanwhile.
    objects = (module for name, module in list(sys.modules.items()) if name.startswith("h5py.") and name.endswith("._objects"))
    lock = getattr(next(objects, None), "phil", None)
    with lock or contextlib.nullcontext():
        yield


def _opened_again(file: str, methods: tuple[str, ...], reach: float, content_id: str) -> Dataset:
    """Opens a pickled dataset again. Raises Error if the file now holds other results."""
    dataset = Dataset(file, methods, reach)
    if dataset.content_id != content_id:
        raise _library.Error(1, f"{file}: was replaced since this dataset was pickled; open the new file and pickle it")
    return dataset


class Dataset(_library.Handle):
    """A dataset in memory, prepared to answer.

    Opening takes from a second to a minute (for a whole surface), and several times the size of the file in memory. Afterwards
    the file may be replaced or removed. Immutable: any number of threads may query at once, and run in parallel, since the global
    interpreter lock is released. ``close`` frees the memory, as does leaving a ``with``. A pickle stores only the path of the
    file; unpickling loads the file again.
    """

    _destroy = "dataset_close"

    def __init__(self, file: str | os.PathLike[str], methods: Sequence[str] | None = None,
                 reach: float = 0.0) -> None:
        """Loads and verifies ``file``.

        methods: interpolation methods to prepare; each takes time and memory. Default: "potential" (conservative) and
        "trilinear". ``palpate query --help`` lists them.
        reach: distance along the surface up to which a contact feels an active node, m. 0: only on the triangles at the node.
        """
        options = _library.OpenOptions(reach=reach)
        if methods is not None:
            names = (c_char_p * len(methods))(*(name.encode() for name in methods))
            options.methods, options.method_count = ctypes.cast(names, POINTER(c_char_p)), len(names)
        handle = c_void_p()
        with hdf5_alone():
            _library.call("dataset_open", os.fsencode(file), byref(options), byref(handle))
        self._path, self._reach = os.path.abspath(os.fsdecode(file)), reach
        self._take(handle)

    def _take(self, handle: c_void_p) -> None:
        self._own(handle)
        self._info = _library.DatasetInfo()
        _library.call("dataset_describe", self.handle, byref(self._info))
        self.name: str = self._info.name.decode()  #: name of the scene
        self.file: str = os.fsdecode(self._info.file)  #: path as given
        self.content_id: str = self._info.content_id.decode()  #: 64 hexadecimal digits, equal for equal results
        self.max_force: float = self._info.max_force  #: N, of the scene; solving does not go on from a point with a larger force
        #: prepared methods, the first is the default
        self.methods: tuple[str, ...] = tuple(bytes(_library.functions["dataset_method"](handle, m)).decode()
                                              for m in range(self._info.method_count))

    @classmethod
    def _of(cls, handle: c_void_p) -> Dataset:
        """Returns a dataset without a file, from its handle."""
        dataset = cls.__new__(cls)
        dataset._path, dataset._reach = "", 0.0
        dataset._take(handle)
        return dataset

    def __reduce__(self) -> Any:
        if not self._path:
            raise TypeError("the dataset of a live scene stays in its process: it has no file")
        return _opened_again, (self._path, self.methods, self._reach, self.content_id)

    def __repr__(self) -> str:
        return f"<palpate.Dataset {self.name!r} of {self.file!r}, {self._info.space_count} spaces>"

    @cached_property
    def spaces(self) -> tuple[SpaceInfo, ...]:
        """The configuration spaces, in the order of the scene; the sites of a finger are spaces too."""
        return tuple(self._space_info(s) for s in range(self._info.space_count))

    @cached_property
    def areas(self) -> tuple[AreaInfo, ...]:
        """The surfaces that a finger can touch anywhere, in the order of the scene; often none."""
        count = c_int32()
        _library.call("dataset_area_count", self.handle, byref(count))
        return tuple(self._area_info(a) for a in range(count.value))

    @cached_property
    def vertices(self) -> Numbers:
        """(V, 3), m: the surface at rest."""
        return self._copied("dataset_vertices", c_double, (self._info.vertex_count, 3))

    @cached_property
    def triangles(self) -> npt.NDArray[np.int32]:
        """(T, 3): vertices of the surface triangles, counterclockwise seen from outside."""
        return self._copied("dataset_triangles", c_int32, (self._info.triangle_count, 3))

    @cached_property
    def touchable(self) -> npt.NDArray[np.bool_]:
        """(T,): whether a contact feels forces on the triangle."""
        return self._copied("dataset_touchable", c_uint8, (self._info.triangle_count,)).astype(np.bool_)

    def query(self, displacements: npt.ArrayLike, at: npt.ArrayLike | None = None, active: str | int | None = None,
              method: str | int = 0, out: Answers | None = None) -> Answers:
        """Returns force, stiffness, energy and error bound at displacements, in one call.

        displacements: (..., 3), m, of the active node from rest. Beyond the computed data, the force is that of a wall that
        stiffens with depth, and ``inside`` is False. A displacement that is not finite gives zero force, without an error.
        at: (..., 3), m, position of a finger on the surface at rest. The answer is that of the nearest place on the surface. If
        ``distance`` exceeds a quarter of the finger's radius, ``inside`` is False. ``at`` is broadcast with ``displacements``.
        active: name or index of the active node, or of the area with ``at``; optional if there is only one.
        method: name or index of a prepared method; a finger with ``at`` has only one.
        out: answers of an earlier call for the same number of displacements, to overwrite without allocation.
        """
        vectors = _vectors(displacements, "displacements")
        if at is None:
            space, number = self._number(active, [s.name for s in self.spaces], "active node"), self._method(method)
            answers, given = _answers(vectors.shape[:-1], _of_all, out)
            _library.call("query_many", self.handle, space, number, _doubles(vectors), vectors.size // 3, byref(given))
            return answers
        area = self._number(active, [a.name for a in self.areas], "area")
        if self._method(method) != 0:
            raise _library.Error(1, f"method {method!r}: a query with `at` has one method only; omit method")
        places, vectors = (np.ascontiguousarray(x) for x in np.broadcast_arrays(_vectors(at, "at"), vectors))
        answers, given = _answers(vectors.shape[:-1], _of_all + _of_areas, out)
        _library.call("area_query_many", self.handle, area, _doubles(places), _doubles(vectors), vectors.size // 3, byref(given))
        return answers

    def shape(self, displacement: npt.ArrayLike, active: str | int | None = None) -> npt.NDArray[np.float32]:
        """Returns the displacements of ``vertices``, (V, 3), m, for a displacement (3,), m, of one active node alone."""
        vector = _vectors(displacement, "displacement")
        if vector.shape != (3,):
            raise ValueError(f"displacement has shape {vector.shape}; it must be one, (3,)")
        shape = np.empty((self._info.vertex_count, 3), np.float32)
        _library.call("displacements", self.handle, self._number(active, [s.name for s in self.spaces], "active node"),
                      _doubles(vector), shape.ctypes.data_as(POINTER(c_float)), shape.size, None)
        return shape

    def _space_info(self, space: int) -> SpaceInfo:
        info = _library.SpaceInfo()
        _library.call("dataset_space", self.handle, space, byref(info))
        return SpaceInfo(info.name.decode(), info.node, info.vertex, np.array(info.rest_position), info.workspace_radius,
                         info.spacing, info.largest_force)

    def _area_info(self, area: int) -> AreaInfo:
        info = _library.AreaInfo()
        _library.call("dataset_area", self.handle, area, byref(info))
        return AreaInfo(info.name.decode(), info.finger_radius, info.workspace_radius, info.site_count)

    def _copied(self, word: str, kind: Any, shape: tuple[int, ...]) -> npt.NDArray[Any]:
        array = np.empty(shape, kind)
        _library.call(word, self.handle, array.ctypes.data_as(POINTER(kind)), c_size_t(array.size))
        return array

    def _method(self, method: str | int) -> int:
        return self._number(method, list(self.methods), "prepared method")

    def _number(self, word: str | int | None, names: list[str], what: str) -> int:
        """Returns the index for ``word``, which is a name, an index, or None if there is only one name."""
        if word is None and len(names) == 1:
            return 0
        if isinstance(word, (int, np.integer)) and 0 <= word < len(names):
            return int(word)
        if isinstance(word, str) and word in names:
            return names.index(word)
        known = ", ".join(names[:12]) + (f", ... {len(names)} in all" if len(names) > 12 else "") or "none"
        raise _library.Error(1, f"{self.file}: " + (f"name the {what}; there are: {known}" if word is None else
                                                     f"there is no {what} {word!r}; there are: {known}"))


def arrays_for(shape: tuple[int, ...], members: Sequence[tuple[str, tuple[int, ...], Any]],
               out: object | None) -> dict[str, npt.NDArray[Any]]:
    """Returns arrays for libpalpate to write into, new or those of ``out``, by the names of ``members``."""
    arrays = {}
    for name, rest, kind in members:
        if out is None:
            arrays[name] = np.empty(shape + rest, kind)
            continue
        given = getattr(out, name)
        fits = given is not None and given.shape == shape + rest and given.dtype == kind
        if not (fits and given.flags.c_contiguous and given.flags.writeable):
            raise ValueError(f"out.{name} must be the array of an earlier answer with shape {shape + rest}")
        arrays[name] = given
    return arrays


def _answers(shape: tuple[int, ...], members: Sequence[tuple[str, tuple[int, ...], Any]],
             out: Answers | None) -> tuple[Answers, _library.Answers]:
    """Returns the answers with their arrays, and the structure with the addresses of the arrays for libpalpate."""
    arrays = arrays_for(shape, members, out)
    pointers = {_members[name]: array.ctypes.data for name, array in arrays.items()}
    return Answers(**arrays) if out is None else out, _library.Answers(**pointers)
