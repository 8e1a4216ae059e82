"""Palpate for Python: forces of a soft body, from the datasets that ``palpate build`` makes.

    >>> import palpate
    >>> liver = palpate.Dataset("liver.h5")
    >>> answers = liver.query([[0.0, 0.0, -0.005], [0.0, 0.0, -0.010]], active="tip")
    >>> answers.force                       # N, of the tissue on the tool, one row per displacement
    >>> answers.error_bound                 # N

What is here:

``Dataset``    a dataset in memory; ``query`` answers any number of displacements in one call
``Contact``    a tool that touches the body, slides and lets go: one position after the other
``Guard``      limits a force to what a haptic device may be given
``Arrays``     what a dataset file holds, as NumPy arrays (needs h5py)
``Recording``  what ``palpate view --record`` wrote, as NumPy arrays (needs h5py)

Everything is in SI units and in the frame of the scene: m, N, N/m, J, Pa. A force is that of the tissue on the tool. Arrays
are C-contiguous; where a number is not known it is NaN. What goes wrong is a ``palpate.Error`` that says what, where and
what to do.

The work is done by libpalpate, a C library (palpate.h is its manual), through ctypes: nothing is compiled against a version of
Python. The global interpreter lock is released while it works, and a dataset may be used by any number of threads at once.
"""

from ._library import Error, version
from .arrays import Arrays, Space
from .contact import Contact, ContactMode, ContactOptions, DeviceProfile, Guard, GuardedForce, GuardOptions, Touch, device
from .dataset import Answers, AreaInfo, Dataset, SpaceInfo
from .recording import Recording

__all__ = [
    "Answers", "AreaInfo", "Arrays", "Contact", "ContactMode", "ContactOptions", "Dataset", "DeviceProfile", "Error", "Guard",
    "GuardOptions", "GuardedForce", "Recording", "Space", "SpaceInfo", "Touch", "device", "version",
]
__version__ = version()
