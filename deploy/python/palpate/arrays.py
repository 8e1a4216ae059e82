"""The contents of a dataset file, as NumPy arrays: every solved lattice point. docs/dataset.md describes the layout."""

from __future__ import annotations

import os
import shlex
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ._library import Error, Numbers

if TYPE_CHECKING:
    import numpy.typing as npt

#: Names for ``Space.tag`` and ``Space.cause``: the numbers in the file are indices into these.
TAGS = ("unknown", "expandable", "terminating", "failed")
CAUSES = ("", "iteration_limit", "line_search_stalled", "inverted_element", "wrong_inertia", "factorization_failed", "not_finite",
          "step_budget", "worker_lost", "unreachable", "limit_point", "beyond_force", "bifurcation")
_majors = (2, 3)


def _is_open_for_writing(name: str) -> bool:
    """Returns whether the version and consistency flags of the superblock mark the file as open for writing."""
    with open(name, "rb") as file:
        head = file.read(12)
    return len(head) == 12 and head[8] >= 3 and head[11] & 5 != 0


def open_hdf5(file: str | os.PathLike[str], what: str, majors: tuple[int, ...]) -> Any:
    """Opens an h5py.File. Raises Error unless its ``format`` is palpate-`what`, of one of these major versions."""
    try:
        import h5py
    except ModuleNotFoundError as missing:
        raise ImportError("arrays of files need h5py: install python3-h5py (or pip install h5py)") from missing
    name = os.fsdecode(file)
    maker = {"dataset": "palpate build makes one", "recording": "palpate view --record makes one"}[what]
    if not os.path.isfile(name):
        raise Error(2, f"{name}: {'is not a file' if os.path.exists(name) else f'there is no such {what}'}; {maker}")
    try:
        opened = h5py.File(os.path.abspath(name), "r")
    except OSError as error:
        if _is_open_for_writing(name):
            raise Error(1, f"{name}: is open for writing in another program (a notebook?), or was never closed: close it there; "
                        f"if no program has it open, run h5clear -s {shlex.quote(name)} (Debian: hdf5-tools)") from None
        said = f"cannot be opened: {str(error).splitlines()[0]}" if h5py.is_hdf5(name) else f"is not an HDF5 file; {maker}"
        raise Error(2, f"{name}: {said}") from None
    found = opened.attrs.get("format", b"")
    major = int(np.ravel(opened.attrs.get("format_version", 0))[0])
    if (found.decode() if isinstance(found, bytes) else found) != "palpate-" + what or major == 0:
        opened.close()
        raise Error(2, f"{name}: not a palpate {what}; {maker}")
    if major not in majors:
        opened.close()
        raise Error(2, f"{name}: has {what} format {major}; this version reads {' and '.join(map(str, majors))}; {maker}")
    return opened


def _table(file: Any, path: str) -> Any:
    """Returns the object at a path of an open file."""
    if not file:
        raise Error(1, f"{path}: the file was closed; read what you need while it is open")
    if path not in file:
        folder = path.rsplit("/", 1)[0]
        raise KeyError(f"there is no /{path}; there are: {', '.join(file[folder])}")
    return file[path]


class Space:
    """The configuration space of one active node: L lattice points. Rows of unsolved points are NaN (see ``solved``)."""

    def __init__(self, file: Any, number: int, name: str) -> None:
        self._file, self._number, self.name = file, number, name
        self._rows = self._rows_of("point")

    def __reduce__(self) -> Any:
        return _space_of, (self._file.filename, self.name)

    def __repr__(self) -> str:
        return f"<palpate.Space {self.name!r}, {np.count_nonzero(self.solved)} of {len(self.tag)} points solved>"

    def _rows_of(self, table: str) -> slice:
        return slice(*map(int, _table(self._file, "spaces/first_" + table)[self._number:self._number + 2]))

    def __getitem__(self, array: str) -> npt.NDArray[Any]:
        """Returns an array of /points by name, for instance "drive" or "newton_iterations"; docs/dataset.md lists them."""
        return np.asarray(_table(self._file, "points/" + array)[self._rows])

    @cached_property
    def position(self) -> Numbers:
        """(L, 3), m: displacements of the active node. The first is the origin."""
        return self["position"]

    @cached_property
    def tag(self) -> npt.NDArray[np.uint8]:
        """(L,): indices into ``TAGS``."""
        return self["tag"]

    @cached_property
    def cause(self) -> npt.NDArray[np.uint8]:
        """(L,): causes of failed points, indices into ``CAUSES``."""
        return self["cause"]

    @cached_property
    def solved(self) -> npt.NDArray[np.bool_]:
        """(L,): whether the point has an equilibrium."""
        return np.isin(self.tag, (1, 2))

    @cached_property
    def force(self) -> Numbers:
        """(L, 3), N: force of the tissue on the tool."""
        return self["force"]

    @cached_property
    def stiffness(self) -> Numbers:
        """(L, 3, 3), N/m: [i, j] = d force[i] / d position[j]."""
        return self["stiffness"]

    @cached_property
    def energy(self) -> Numbers:
        """(L,), J: stored energy, relative to the rest state."""
        return self["energy"]

    @cached_property
    def min_det_F(self) -> Numbers:
        """(L,): smallest determinant of the deformation gradient over the tetrahedra."""
        return self["min_det_F"]

    def displacement(self, points: Any = slice(None)) -> npt.NDArray[np.float32]:
        """(n, V, 3), m: displacements of ``Arrays.stored_nodes`` at these points (an index, slice or mask; default all)."""
        numbers = np.arange(self._rows.start, self._rows.stop)[points]
        table = _table(self._file, "points/displacement")
        rows = np.empty(np.shape(numbers) + table.shape[1:], np.float32)
        flat = rows.reshape(-1, *table.shape[1:])
        for row, number in enumerate(np.ravel(numbers)):
            flat[row] = table[number]
        if table.dtype == np.int16:
            step = _table(self._file, "points/displacement_step")[self._rows][points]
            rows[rows == np.iinfo(np.int16).min] = np.nan
            rows *= np.reshape(step, np.shape(numbers) + (1, 1))
        return rows

    @cached_property
    def probes(self) -> dict[str, npt.NDArray[Any]]:
        """Exact solutions off the lattice, unused by the interpolation: arrays of /probes ("position", "force", "tag", ...)."""
        rows = self._rows_of("probe")
        return {name: np.asarray(array[rows]) for name, array in _table(self._file, "probes").items()}


def _space_of(file: str, name: str) -> Space:
    """Opens a pickled space again."""
    return Arrays(file)[name]


class Arrays:
    """A dataset file as NumPy arrays, read on first use. A context manager that closes the file.

        >>> with palpate.Arrays("liver.h5") as arrays:
        ...     tip = arrays["tip"]
        ...     print(tip.position[tip.solved], tip.force[tip.solved])

    Unlike ``Dataset``, it reads with h5py and prepares nothing. One thread at a time. A pickle stores the path of the file.
    """

    def __init__(self, file: str | os.PathLike[str]) -> None:
        self._file = open_hdf5(file, "dataset", _majors)
        #: names of the active nodes, in the order of the scene
        self.names: tuple[str, ...] = tuple(bytes(name).rstrip(b"\0").decode() for name in self._file["spaces/name"])
        self.scene: str = self._text("scene_toml")  #: the resolved scene, as TOML
        self.content_hash: str = self._text("content_hash")  #: equal for datasets with equal results

    def __reduce__(self) -> Any:
        return Arrays, (self._file.filename,)

    def _text(self, attribute: str) -> str:
        value = self._file.attrs[attribute]
        return value.decode() if isinstance(value, bytes) else str(value)

    def __getitem__(self, name: str) -> Space:
        """Returns the space of an active node."""
        if name not in self.names:
            raise KeyError(f"there is no active node {name!r}; there are: {', '.join(self.names[:12])}"
                           + (f", ... {len(self.names)} in all" if len(self.names) > 12 else ""))
        return Space(self._file, self.names.index(name), name)

    def __iter__(self) -> Any:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def nodes(self) -> Numbers:
        """(N, 3), m: rest positions of the nodes."""
        return np.asarray(_table(self._file, "mesh/points"))

    @cached_property
    def tetrahedra(self) -> npt.NDArray[np.int32]:
        """(M, 4): node numbers, positive orientation."""
        return np.asarray(_table(self._file, "mesh/tetrahedra"))

    @cached_property
    def surface(self) -> npt.NDArray[np.int32]:
        """(T, 3): boundary triangles, node numbers, normals outward."""
        return np.asarray(_table(self._file, "mesh/surface"))

    @cached_property
    def fixed_nodes(self) -> npt.NDArray[np.int32]:
        """Numbers of the fixed nodes, ascending."""
        return np.asarray(_table(self._file, "mesh/fixed_nodes"))

    @cached_property
    def stored_nodes(self) -> npt.NDArray[np.int32]:
        """(V,): numbers of the nodes in ``Space.displacement``, ascending."""
        return np.asarray(_table(self._file, "mesh/stored_nodes"))

    def close(self) -> None:
        """Closes the file; arrays already read stay valid."""
        self._file.close()

    def __enter__(self) -> Arrays:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
