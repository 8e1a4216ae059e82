"""Runs of ``palpate view --record``, as NumPy arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ._library import ByValue, Numbers
from .arrays import open_hdf5

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class Recording(ByValue):
    """The readings and forces of n ticks. All but ``device_position`` are in the frame of the scene."""

    time: Numbers  #: (n,), s
    device_position: Numbers  #: (n, 3), m, in the device's frame
    buttons: npt.NDArray[np.int32]  #: (n,), bits
    status: npt.NDArray[np.uint8]  #: (n,): 0 fresh, 1 repeated, 2 lost, 3 away (no hand in the scene)
    tool: Numbers  #: (n, 3), m
    force: Numbers  #: (n, 3), N, sent to the device
    raw_force: Numbers  #: (n, 3), N, of the tissue, before the guard's limits
    touching: npt.NDArray[np.bool_]  #: (n,)
    anchor: Numbers  #: (n, 3), m, the point of contact at rest; 0 without contact
    displacement: Numbers  #: (n, 3), m, of the anchor
    inside: npt.NDArray[np.bool_]  #: (n,): False beyond the computed data; True in older recordings
    coverage: Numbers  #: (n,), 0 to 1, as in ``Answers``; NaN in older recordings
    energy: Numbers  #: (n,), J, stored in the tissue; NaN: method without energy
    error_bound: Numbers  #: (n,), N; NaN: unknown
    hold_anchor: Numbers  #: (n, 3), m, the place at rest of a second finger that holds the body; NaN without one
    hold_displacement: Numbers  #: (n, 3), m, of this place
    hold_force: Numbers  #: (n, 3), N, of the tissue on this finger; NaN: unknown
    hold_error_bound: Numbers  #: (n,), N, of this force
    guards: npt.NDArray[np.int32]  #: (n,), bits of the active force limits
    attributes: dict[str, Any]  #: datasets, methods, device and options of the run

    @staticmethod
    def read(file: str | os.PathLike[str]) -> Recording:
        """Reads a recording. Raises Error if the file is not one."""
        with open_hdf5(file, "recording", (1,)) as f:
            def array(path: str) -> npt.NDArray[Any]:
                return np.asarray(f[path])

            time = array("time")
            older = "contact/inside" not in f
            inside = np.ones(time.shape) if older else array("contact/inside")
            coverage = np.full(time.shape, np.nan) if older else array("contact/coverage")
            held = {name: array("hold/" + name) if "hold" in f else np.full((*time.shape, *shape), np.nan)
                    for name, shape in (("anchor", (3,)), ("displacement", (3,)), ("force", (3,)), ("error_bound", ()))}
            attributes = {name: value.decode() if isinstance(value, bytes) else value for name, value in f.attrs.items()}
            return Recording(time=time, device_position=array("device/position"), buttons=array("device/buttons"),
                             status=array("device/status"), tool=array("tool/position"), force=array("force/rendered"),
                             raw_force=array("force/raw"), touching=array("contact/touching").astype(np.bool_),
                             anchor=array("contact/anchor"), displacement=array("contact/displacement"),
                             inside=inside.astype(np.bool_), coverage=coverage,
                             energy=array("contact/energy"), error_bound=array("contact/error_bound"), guards=array("guards"),
                             attributes=attributes, **{"hold_" + name: values for name, values in held.items()})
