"""Palpate for Python: forces of a soft body, from the datasets that ``palpate build`` writes.

    >>> import palpate
    >>> liver = palpate.Dataset("liver.h5")
    >>> answers = liver.query([[0.0, 0.0, -0.005], [0.0, 0.0, -0.010]], active="tip")
    >>> answers.force                       # N, of the tissue on the tool, one row per displacement
    >>> answers.error_bound                 # N

Contents:

``Dataset``    a dataset in memory; ``query`` answers any number of displacements in one call
``Contact``    a tool that touches the body, slides and lets go, one position at a time
``Contacts``   thousands of such tools, each with its own contact, in one call
``Sensor``     force and torque on the tools of a physics engine, in its frame and units
``Live``       a solver that follows the hand: exact forces near it, also without a dataset
``Guard``      makes a force safe for a haptic device
``Arrays``     the contents of a dataset file, as NumPy arrays (needs h5py)
``Recording``  the run that ``palpate view --record`` wrote, as NumPy arrays (needs h5py)

All values are in SI units and in the frame of the scene: m, N, N/m, J, Pa. A force is that of the tissue on the tool. Arrays
are C-contiguous; an unknown number is NaN. Failures raise ``palpate.Error``, which gives the cause, the place and the remedy.

The package calls libpalpate, a C library (palpate.h is its manual), through ctypes, so it works with any version of Python. It
releases the global interpreter lock during calls, and any number of threads may use a dataset at once.
"""

from ._library import Error, version
from .arrays import Arrays, Space
from .contact import Contact, ContactMode, ContactOptions, DeviceProfile, Guard, GuardedForce, GuardOptions, Touch, device
from .contacts import Contacts, Touches
from .dataset import Answers, AreaInfo, Dataset, SpaceInfo
from .live import Live, LiveInfo
from .recording import Recording
from .sensor import Sensor, Wrench, facing_up

__all__ = [
    "Answers", "AreaInfo", "Arrays", "Contact", "ContactMode", "ContactOptions", "Contacts", "Dataset", "DeviceProfile", "Error",
    "Guard", "GuardOptions", "GuardedForce", "Live", "LiveInfo", "Recording", "Sensor", "Space", "SpaceInfo", "Touch", "Touches",
    "Wrench", "device", "facing_up", "version",
]
__version__ = version()
