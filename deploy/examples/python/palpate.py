"""libpalpate for Python: forces of a soft body from a Palpate dataset. Standard library only.

    with palpate.Dataset("liver.h5") as liver:
        sample = liver.query("tip", (0.0, 0.0, -0.005))
        print(sample.force, sample.error_bound, sample.coverage)

Units and frame are those of palpate.h: metres, newtons, the frame of the scene. Points may be any three numbers, numpy arrays
too. Python is no real-time language: for loops at 1 kHz that a hand feels write C; this is for scripts, tests and slow loops.
PALPATE_LIBRARY in the environment names a library that is not where the system looks.
"""

import ctypes
import ctypes.util
import os
from ctypes import POINTER, Structure, byref, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint8, c_uint32, c_void_p

OK, INVALID_ARGUMENT, BAD_FILE, OUT_OF_MEMORY, FAILED = range(5)
UNILATERAL, GLUED = range(2)
READING_FRESH, READING_LOST, LOOP_LATE = 1, 2, 4
GUARDS = ("ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late")

Vector = c_double * 3
Matrix = c_double * 9


class Error(Exception):
    """What the library says went wrong; `status` is its palpate_status."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


class _Sized(Structure):
    """A structure of palpate.h that knows its size, as every one of them must."""

    def __init__(self, **members):
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


class Sample(_Sized):
    _fields_ = [("size", c_size_t), ("force", Vector), ("stiffness", Matrix), ("energy", c_double),
                ("error_bound", c_double), ("coverage", c_double), ("inside", c_int32), ("reserved", c_int32)]


class ContactOptions(_Sized):
    _fields_ = [("size", c_size_t), ("mode", c_int32), ("method", c_int32), ("friction", c_double),
                ("grab_distance", c_double), ("most_slide", c_double), ("most_relaxation", c_double)]


class Touch(_Sized):
    _fields_ = [("size", c_size_t), ("touching", c_int32), ("stepped", c_int32), ("inside", c_int32),
                ("triangle", c_int32), ("force", Vector), ("stiffness", Matrix), ("energy", c_double),
                ("error_bound", c_double), ("coverage", c_double), ("barycentric", Vector), ("anchor", Vector),
                ("normal", Vector), ("displacement", Vector), ("gap", c_double), ("share_count", c_int32),
                ("share_spaces", c_int32 * 9), ("share_weights", c_double * 9)]


class Profile(_Sized):
    _fields_ = [("size", c_size_t), ("name", c_char_p), ("max_force", c_double), ("max_stiffness", c_double),
                ("workspace_radius", c_double)]


class GuardOptions(_Sized):
    _fields_ = [("size", c_size_t), ("period", c_double), ("max_force", c_double), ("max_slew", c_double),
                ("ramp", c_double), ("stall", c_double), ("max_stiffness", c_double), ("energy_credit", c_double)]


class GuardedForce(_Sized):
    _fields_ = [("size", c_size_t), ("force", Vector), ("passivity", c_double), ("guards", c_uint32),
                ("reserved", c_uint32)]

    def why(self):
        """Words for what limited this force."""
        return [word for bit, word in enumerate(GUARDS) if self.guards >> bit & 1]


def _load():
    name = os.environ.get("PALPATE_LIBRARY") or ctypes.util.find_library("palpate") or "libpalpate.so.0"
    library = ctypes.CDLL(name)
    handle, status = c_void_p, c_int32
    signatures = {
        "version": (c_char_p, []),
        "abi_version": (c_int32, []),
        "last_error": (c_char_p, []),
        "dataset_open": (status, [c_char_p, POINTER(OpenOptions), POINTER(handle)]),
        "dataset_close": (None, [handle]),
        "dataset_describe": (status, [handle, POINTER(DatasetInfo)]),
        "dataset_space": (status, [handle, c_int32, POINTER(SpaceInfo)]),
        "dataset_find_space": (status, [handle, c_char_p, POINTER(c_int32)]),
        "dataset_method": (c_char_p, [handle, c_int32]),
        "dataset_find_method": (status, [handle, c_char_p, POINTER(c_int32)]),
        "dataset_vertices": (status, [handle, POINTER(c_double), c_size_t]),
        "dataset_triangles": (status, [handle, POINTER(c_int32), c_size_t]),
        "dataset_touchable": (status, [handle, POINTER(c_uint8), c_size_t]),
        "query": (status, [handle, c_int32, c_int32, Vector, POINTER(Sample)]),
        "displacements": (status, [handle, c_int32, Vector, POINTER(c_float), c_size_t, POINTER(c_int32)]),
        "contact_defaults": (status, [handle, POINTER(ContactOptions)]),
        "contact_create": (status, [handle, POINTER(ContactOptions), POINTER(handle)]),
        "contact_destroy": (None, [handle]),
        "contact_update": (status, [handle, Vector, c_int32, POINTER(Touch)]),
        "contact_release": (status, [handle]),
        "contact_use": (status, [handle, handle, c_int32]),
        "touch_displacements": (status, [handle, POINTER(Touch), POINTER(c_float), c_size_t]),
        "device_profile": (status, [c_char_p, POINTER(Profile)]),
        "guard_defaults": (status, [c_char_p, c_double, POINTER(GuardOptions)]),
        "guard_create": (status, [POINTER(GuardOptions), POINTER(handle)]),
        "guard_destroy": (None, [handle]),
        "guard_limit": (status, [handle, Vector, POINTER(Touch), c_uint32, POINTER(GuardedForce)]),
        "guard_reset": (status, [handle]),
    }
    functions = {}
    for word, (result, arguments) in signatures.items():
        function = getattr(library, "palpate_" + word)
        function.restype, function.argtypes = result, arguments
        functions[word] = function
    if functions["abi_version"]() != 0:
        raise ImportError(f"{name} has ABI {functions['abi_version']()}, this module is for 0")
    return functions


_functions = _load()


def _call(word, *arguments):
    status = _functions[word](*arguments)
    if status != OK:
        raise Error(status, _functions["last_error"]().decode(errors="replace"))


def version():
    return _functions["version"]().decode()


def device(name):
    profile = Profile()
    _call("device_profile", name.encode(), byref(profile))
    return profile


class _Handle:
    """Owns a handle of the library: a context manager, given back once."""

    _handle, _destroy = None, ""

    def close(self):
        if self._handle:
            _functions[self._destroy](self._handle)
            self._handle = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        self.close()


class Dataset(_Handle):
    _destroy = "dataset_close"

    def __init__(self, file, methods=None, reach=0.0):
        """methods: names, the default None prepares "potential" and "trilinear"."""
        options = OpenOptions(reach=reach)
        if methods:
            names = (c_char_p * len(methods))(*(name.encode() for name in methods))
            options.methods, options.method_count = names, len(names)
        handle = c_void_p()
        _call("dataset_open", os.fsencode(file), byref(options), byref(handle))
        self._handle = handle

    def info(self):
        """A DatasetInfo; its texts live as long as this dataset."""
        info = DatasetInfo()
        _call("dataset_describe", self._handle, byref(info))
        return info

    def space(self, space):
        """A SpaceInfo, by number or name."""
        info = SpaceInfo()
        _call("dataset_space", self._handle, self._space(space), byref(info))
        return info

    def methods(self):
        return [_functions["dataset_method"](self._handle, m).decode() for m in range(self.info().method_count)]

    def vertices(self):
        """Rest positions of the surface, flat: x, y, z of each vertex."""
        return self._copied("dataset_vertices", c_double, 3 * self.info().vertex_count)

    def triangles(self):
        """Vertex numbers, flat: three of each triangle."""
        return self._copied("dataset_triangles", c_int32, 3 * self.info().triangle_count)

    def touchable(self):
        """1 or 0 for each triangle."""
        return self._copied("dataset_touchable", c_uint8, self.info().triangle_count)

    def query(self, space, displacement, method=0):
        """A Sample; space and method by number or name."""
        sample = Sample()
        _call("query", self._handle, self._space(space), self._method(method), Vector(*displacement), byref(sample))
        return sample

    def displacements(self, space, displacement):
        """Of the vertices, flat, when the space's active node alone is displaced."""
        out = (c_float * (3 * self.info().vertex_count))()
        _call("displacements", self._handle, self._space(space), Vector(*displacement), out, len(out), None)
        return out

    def shape(self, touch):
        """Displacements of the vertices, flat, of a contact with this dataset."""
        out = (c_float * (3 * self.info().vertex_count))()
        _call("touch_displacements", self._handle, byref(touch), out, len(out))
        return out

    def contact_options(self):
        options = ContactOptions()
        _call("contact_defaults", self._handle, byref(options))
        return options

    def contact(self, options=None):
        return Contact(self, options)

    def _copied(self, word, kind, count):
        out = (kind * count)()
        _call(word, self._handle, out, count)
        return out

    def _space(self, space):
        return space if isinstance(space, int) else self._number("dataset_find_space", space)

    def _method(self, method):
        return method if isinstance(method, int) else self._number("dataset_find_method", method)

    def _number(self, word, name):
        number = c_int32()
        _call(word, self._handle, name.encode(), byref(number))
        return number.value


class Contact(_Handle):
    """A point tool on a dataset's body. One thread at a time."""

    _destroy = "contact_destroy"

    def __init__(self, dataset, options=None):
        handle = c_void_p()
        _call("contact_create", dataset._handle, byref(options) if options else None, byref(handle))
        self._handle = handle

    def update(self, tool, hold=True):
        """A Touch for the next position of the tool, metres."""
        touch = Touch()
        _call("contact_update", self._handle, Vector(*tool), int(hold), byref(touch))
        return touch

    def release(self):
        _call("contact_release", self._handle)

    def use(self, dataset, method=0):
        _call("contact_use", self._handle, dataset._handle, dataset._method(method))


class Guard(_Handle):
    """Limits forces to what a device may be given. One thread at a time."""

    _destroy = "guard_destroy"

    def __init__(self, device=None, period=1e-3, options=None):
        """options: GuardOptions; without them those of a device by name."""
        if options is None:
            options = GuardOptions()
            _call("guard_defaults", device.encode() if device else None, period, byref(options))
        handle = c_void_p()
        _call("guard_create", byref(options), byref(handle))
        self._handle = handle

    def limit(self, tool, touch, flags=READING_FRESH):
        """A GuardedForce. Should this raise, send zero."""
        force = GuardedForce()
        _call("guard_limit", self._handle, Vector(*tool), byref(touch), flags, byref(force))
        return force

    def reset(self):
        _call("guard_reset", self._handle)
