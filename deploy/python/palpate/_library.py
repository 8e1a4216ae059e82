"""ctypes bindings of libpalpate: its structures, its functions and its location. palpate.h documents them."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
from collections.abc import Callable, Iterator
from ctypes import POINTER, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from pathlib import Path
from typing import TYPE_CHECKING, Any

try:
    import numpy as np
except ModuleNotFoundError as missing:
    raise ImportError("palpate needs NumPy: install python3-numpy (or pip install numpy)") from missing

if TYPE_CHECKING:  # NumPy of Debian 11 has no numpy.typing
    import numpy.typing as npt

    Numbers = npt.NDArray[np.float64]
else:
    Numbers = np.ndarray

ABI_VERSION = 0
SONAME = f"libpalpate.so.{ABI_VERSION}"
OK = 0

Vector = c_double * 3
Matrix = c_double * 9
MOST_SHARES = 9


class Error(Exception):
    """A failure of libpalpate or of a file: its cause, place and remedy.

    ``status`` is the palpate_status: 1 invalid argument, 2 bad file, 3 out of memory, 4 other.
    """

    def __init__(self, status: int, text: str) -> None:
        super().__init__(status, text)  # both, so that it can be pickled
        self.status = status

    def __str__(self) -> str:
        return str(self.args[1])


class _Sized(ctypes.Structure):
    """A structure of palpate.h, with its size filled in as the library requires."""

    def __init__(self, **members: Any) -> None:
        super().__init__(size=ctypes.sizeof(self), **members)


class OpenOptions(_Sized):
    _fields_ = [("size", c_size_t), ("methods", POINTER(c_char_p)), ("method_count", c_size_t), ("reach", c_double)]


class DatasetInfo(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("file", c_char_p), ("content_id", c_char_p),
                ("contact_mode", c_int32), ("space_count", c_int32), ("method_count", c_int32),
                ("vertex_count", c_int32), ("triangle_count", c_int32), ("reserved", c_int32), ("max_force", c_double)]


class SpaceInfo(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("node", c_int32), ("vertex", c_int32),
                ("rest_position", Vector), ("workspace_radius", c_double), ("spacing", c_double),
                ("largest_force", c_double)]


class AreaInfo(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("finger_radius", c_double), ("workspace_radius", c_double),
                ("site_count", c_int32), ("reserved", c_int32)]


class Answers(_Sized):
    _fields_ = [("size", c_size_t), ("forces", c_void_p), ("stiffnesses", c_void_p), ("energies", c_void_p),
                ("error_bounds", c_void_p), ("coverages", c_void_p), ("inside", c_void_p), ("drives", c_void_p),
                ("places", c_void_p), ("triangles", c_void_p), ("distances", c_void_p)]


class ContactOptions(_Sized):
    _fields_ = [("size", c_size_t), ("mode", c_int32), ("method", c_int32), ("friction", c_double),
                ("grab_distance", c_double), ("most_slide", c_double), ("most_relaxation", c_double), ("live", c_void_p)]


class LiveOptions(_Sized):
    _fields_ = [("size", c_size_t), ("period", c_double), ("worker", c_char_p), ("follower", c_char_p), ("keys", c_char_p)]


class LiveInfo(_Sized):
    _fields_ = [("size", c_size_t), ("ready", c_int32), ("reserved", c_int32), ("answers", c_uint64), ("failures", c_uint64),
                ("restarts", c_uint64), ("mean_seconds", c_double), ("largest_seconds", c_double)]


class Touch(_Sized):
    _fields_ = [("size", c_size_t), ("touching", c_int32), ("stepped", c_int32), ("inside", c_int32),
                ("triangle", c_int32), ("force", Vector), ("stiffness", Matrix), ("energy", c_double),
                ("error_bound", c_double), ("coverage", c_double), ("barycentric", Vector), ("anchor", Vector),
                ("normal", Vector), ("displacement", Vector), ("gap", c_double), ("share_count", c_int32),
                ("share_spaces", c_int32 * MOST_SHARES), ("share_weights", c_double * MOST_SHARES),
                ("beyond", c_double), ("drive", Vector)]


class Touches(_Sized):
    _fields_ = [("size", c_size_t), ("touching", c_void_p), ("stepped", c_void_p), ("inside", c_void_p), ("triangles", c_void_p),
                ("forces", c_void_p), ("stiffnesses", c_void_p), ("energies", c_void_p), ("error_bounds", c_void_p),
                ("coverages", c_void_p), ("anchors", c_void_p), ("normals", c_void_p), ("displacements", c_void_p),
                ("gaps", c_void_p), ("beyond", c_void_p), ("drives", c_void_p)]


class Profile(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("max_force", c_double), ("max_stiffness", c_double),
                ("workspace_radius", c_double)]


class GuardOptions(_Sized):
    _fields_ = [("size", c_size_t), ("period", c_double), ("max_force", c_double), ("max_slew", c_double),
                ("ramp", c_double), ("stall", c_double), ("max_stiffness", c_double), ("energy_credit", c_double),
                ("delay", c_double)]


class GuardedForce(_Sized):
    _fields_ = [("size", c_size_t), ("force", Vector), ("passivity", c_double), ("guards", c_uint32),
                ("reserved", c_uint32)]


_handle, _status = c_void_p, c_int32
_signatures: dict[str, tuple[Any, list[Any]]] = {
    "version": (c_char_p, []),
    "abi_version": (c_int32, []),
    "last_error": (c_char_p, []),
    "dataset_open": (_status, [c_char_p, POINTER(OpenOptions), POINTER(_handle)]),
    "dataset_close": (None, [_handle]),
    "dataset_describe": (_status, [_handle, POINTER(DatasetInfo)]),
    "dataset_space": (_status, [_handle, c_int32, POINTER(SpaceInfo)]),
    "dataset_method": (c_char_p, [_handle, c_int32]),
    "dataset_vertices": (_status, [_handle, POINTER(c_double), c_size_t]),
    "dataset_triangles": (_status, [_handle, POINTER(c_int32), c_size_t]),
    "dataset_touchable": (_status, [_handle, POINTER(c_uint8), c_size_t]),
    "dataset_area_count": (_status, [_handle, POINTER(c_int32)]),
    "dataset_area": (_status, [_handle, c_int32, POINTER(AreaInfo)]),
    "displacements": (_status, [_handle, c_int32, POINTER(c_double), POINTER(c_float), c_size_t, POINTER(c_int32)]),
    "query_many": (_status, [_handle, c_int32, c_int32, POINTER(c_double), c_size_t, POINTER(Answers)]),
    "area_query_many": (_status, [_handle, c_int32, POINTER(c_double), POINTER(c_double), c_size_t, POINTER(Answers)]),
    "contact_defaults": (_status, [_handle, POINTER(ContactOptions)]),
    "contact_create": (_status, [_handle, POINTER(ContactOptions), POINTER(_handle)]),
    "contact_destroy": (None, [_handle]),
    "contact_update": (_status, [_handle, POINTER(c_double), c_int32, POINTER(Touch)]),
    "contact_release": (_status, [_handle]),
    "contact_use": (_status, [_handle, _handle, c_int32]),
    "contacts_create": (_status, [_handle, POINTER(ContactOptions), c_size_t, c_int32, POINTER(_handle)]),
    "contacts_destroy": (None, [_handle]),
    "contacts_follow": (_status, [_handle, c_size_t, _handle]),
    "contacts_set_frictions": (_status, [_handle, POINTER(c_double)]),
    "contacts_update": (_status, [_handle, POINTER(c_double), POINTER(c_uint8), POINTER(Touches)]),
    "contacts_touch": (_status, [_handle, c_size_t, POINTER(Touch)]),
    "contacts_release": (_status, [_handle, POINTER(c_uint8)]),
    "touch_displacements": (_status, [_handle, POINTER(Touch), POINTER(c_float), c_size_t]),
    "live_start": (_status, [c_char_p, _handle, POINTER(LiveOptions), POINTER(_handle)]),
    "live_stop": (None, [_handle]),
    "live_dataset": (_status, [_handle, POINTER(_handle)]),
    "live_hold": (_status, [_handle, POINTER(c_double), POINTER(c_double)]),
    "live_hold_force": (_status, [_handle, POINTER(c_double)]),
    "live_describe": (_status, [_handle, POINTER(LiveInfo)]),
    "live_trouble": (_status, [_handle, c_char_p, c_size_t]),
    "device_profile": (_status, [c_char_p, POINTER(Profile)]),
    "guard_defaults": (_status, [c_char_p, c_double, POINTER(GuardOptions)]),
    "guard_create": (_status, [POINTER(GuardOptions), POINTER(_handle)]),
    "guard_destroy": (None, [_handle]),
    "guard_limit": (_status, [_handle, POINTER(c_double), POINTER(Touch), c_uint32, POINTER(GuardedForce)]),
    "guard_reset": (_status, [_handle]),
}


def _candidates() -> Iterator[str]:
    """Yields candidates for libpalpate: PALPATE_LIBRARY if it is set, else those near this package, then the system's."""
    if named := os.environ.get("PALPATE_LIBRARY"):
        yield named
        return
    for folder in Path(__file__).resolve().parents:
        for found in [folder / SONAME, *folder.glob(f"*-linux-gnu/{SONAME}"), folder / "build" / "release" / "lib" / SONAME]:
            if found.is_file():
                yield str(found)
    yield ctypes.util.find_library("palpate") or SONAME


def _load() -> tuple[str, dict[str, Callable[..., Any]]]:
    """Loads the library. Returns its file and its functions, by their names without "palpate_"."""
    refusals: list[str] = []
    for name in _candidates():
        try:
            library = ctypes.CDLL(name)  # calls release the global interpreter lock
        except OSError as error:  # absent, or of another architecture
            refusals.append(f"{name}: {error}")
            continue
        functions = {}
        try:
            for word, (result, arguments) in _signatures.items():
                function = getattr(library, "palpate_" + word)
                function.restype, function.argtypes = result, arguments
                functions[word] = function
        except AttributeError as error:
            refusals.append(f"{name} is older than this package: {error}; install the same version of both")
            continue
        if (abi := functions["abi_version"]()) != ABI_VERSION:
            refusals.append(f"{name} has ABI {abi}, this package needs {ABI_VERSION}; install the same version of both")
            continue
        return name, functions
    raise ImportError("palpate cannot load libpalpate: " + "; ".join(refusals) + ". Install libpalpate0, build it "
                      "(cmake --build --preset release), or set PALPATE_LIBRARY to its file")


library_file, functions = _load()


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        one, other = np.asarray(one), np.asarray(other)
        return one.shape == other.shape and bool(((one == other) | ((one != one) & (other != other))).all())
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    return bool(one == other or (one != one and other != other))


class ByValue:
    """Equality by value for dataclasses with arrays: all members are equal; NaN equals NaN."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(_same(value, vars(other)[name]) for name, value in vars(self).items() if not name.startswith("_"))


def last_error() -> str:
    """Returns the message of the last failure in this thread."""
    return bytes(functions["last_error"]()).decode(errors="replace")


def call(word: str, *arguments: Any) -> None:
    """Calls palpate_`word`; raises Error if it fails."""
    status = functions[word](*arguments)
    if status != OK:
        raise Error(status, last_error())


def version() -> str:
    """Returns the version of libpalpate, for instance "0.1.0"."""
    return bytes(functions["version"]()).decode()


class _Owned:
    """A handle of the library, freed with the last reference to it. A call in another thread holds a reference while it runs."""

    def __init__(self, handle: c_void_p, destroy: str) -> None:
        self._as_parameter_, self._destroy = handle, functions[destroy]  # the value that ctypes passes to C

    def __del__(self) -> None:
        self._destroy(self._as_parameter_)


class Handle:
    """An object with a handle of the library; a context manager."""

    _handle: _Owned | None = None
    _destroy = ""

    def _own(self, handle: c_void_p) -> None:
        self._handle = _Owned(handle, self._destroy)

    def close(self) -> None:
        """Makes the object unusable, and frees its handle when nothing else uses it. Without this call, Python frees the
        handle with the last reference."""
        self._handle = None

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __copy__(self) -> Any:
        again = object.__new__(type(self))
        vars(again).update(vars(self))
        return again

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} stays in its process: send its arguments instead, and create another one there")

    @property
    def handle(self) -> _Owned:
        """The handle for calls of the library. Raises Error after ``close``."""
        if self._handle is None:
            raise Error(1, f"this {type(self).__name__} was closed")
        return self._handle
