"""A live solver: exact forces near the hand, also of a scene without a dataset."""

from __future__ import annotations

import ctypes
import os
import shutil
import sysconfig
from ctypes import byref, c_void_p
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import _library
from ._library import Numbers
from .dataset import Dataset, hdf5_alone, position

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True)
class LiveInfo:
    """How well a live solver keeps up with the hand."""

    ready: bool  #: the live solver answers
    trouble: str  #: current problem as a sentence; "" if there is none
    answers: int  #: number of equilibria received
    failures: int  #: number of hand positions without an equilibrium
    restarts: int  #: number of restarts and reconnections of the live solver
    mean_seconds: float  #: s, from question to answer; 0 before the first answer
    largest_seconds: float  #: s


class Live(_library.Handle):
    """A process that solves for equilibria near the hand while it moves, and corrects the forces of one contact.

    Use it as ``Contact(live.dataset, live=live)``. The forces follow the hand in real time, so update the contact every
    ``period`` seconds. A contact keeps its live solver until the contact is closed.
    """

    _destroy = "live_stop"

    def __init__(self, scene: str | os.PathLike[str], dataset: Dataset | None = None, *, period: float = 0.001,
                 worker: str | os.PathLike[str] | None = None, follower: str | None = None, keys: str | None = None) -> None:
        """Starts the live solver and waits until it is ready, which takes seconds.

        scene: file of the scene. dataset: the dataset of this scene that is corrected. None: a guess without computed data,
        whose forces are marked as not inside.
        period: s, between two updates of the contact.
        worker: path of the program palpate-worker; None: found in PATH, or beside Python. follower: address of
        ``palpate follow`` on another machine; None: a worker is started here. keys: folder of the keys for ``follower``; "": none.
        """
        if worker is None and follower is None:  # pip installs it there
            folders = [os.environ.get("PATH", os.defpath), sysconfig.get_path("scripts")]
            worker = shutil.which("palpate-worker", path=os.pathsep.join(folders))
        options = _library.LiveOptions(period=period, worker=None if worker is None else os.fsencode(worker),
                                       follower=None if follower is None else follower.encode(),
                                       keys=None if keys is None else os.fsencode(keys))
        handle = c_void_p()
        with hdf5_alone():
            _library.call("live_start", os.fsencode(scene), None if dataset is None else dataset.handle, byref(options),
                          byref(handle))
        self._own(handle)
        if dataset is None:
            corrected = c_void_p()
            _library.call("live_dataset", self.handle, byref(corrected))
            dataset = Dataset._of(corrected)
        self.dataset: Dataset = dataset  #: for the contact

    def hold(self, place: npt.ArrayLike, displacement: npt.ArrayLike) -> None:
        """Lets a second finger hold the body while the contact touches it, for instance for a pinch.

        It sticks to the surface at ``place`` (m, at rest) and keeps the ``displacement`` (m) there, also if it must pull.
        Call it again to move it or to slide it over the surface. A jump of the place or the displacement by over a quarter of
        the finger's radius is a new hold. The contact feels a hold as soon as the live solver has answered.
        """
        _library.call("live_hold", self.handle, position(place), position(displacement))

    def let_go(self) -> None:
        """Ends the hold."""
        _library.call("live_hold", self.handle, None, None)

    @property
    def hold_force(self) -> Numbers:
        """Force of the tissue on the hold in the last update, N.

        NaN without a hold, while the contact does not touch, and before the live solver has answered.
        """
        force = _library.Vector()
        _library.call("live_hold_force", self.handle, force)
        return np.array(force)

    @property
    def info(self) -> LiveInfo:
        """The state of the live solver now."""
        given, text = _library.LiveInfo(), ctypes.create_string_buffer(1024)
        _library.call("live_describe", self.handle, byref(given))
        _library.call("live_trouble", self.handle, text, len(text))
        return LiveInfo(bool(given.ready), text.value.decode(errors="replace"), given.answers, given.failures, given.restarts,
                        given.mean_seconds, given.largest_seconds)
