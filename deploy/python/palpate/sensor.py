"""A force sensor for soft tissue, in the loop of a physics engine.

Sketches for engines that are not in Debian. They were NOT run: check names, frames and signs in the manual of your version.
``sensor`` is ``palpate.Sensor(dataset, ...)``. ``n`` bodies ``tool`` in as many environments have one sensor with count = n.

Newton (quaternion with w last; wrench in the world frame, force first, torque about the centre of mass)::

    x = state.body_q.numpy()[tool]
    felt = sensor.step(dt, x[:3], np.roll(x[3:], 1), about=centre_of_mass)      # of the tool, in the world
    wrenches = state.body_f.numpy()                                             # after state.clear_forces()
    wrenches[tool] += [*felt.force, *felt.torque]
    state.body_f.assign(wrenches)

Isaac Lab 2.3 (w first; the positions contain the origin of each environment)::

    x = (robot.data.body_pos_w[:, tool] - scene.env_origins).cpu().numpy()
    felt = sensor.step(dt, x, robot.data.body_quat_w[:, tool].cpu().numpy())
    force, torque = (torch.tensor(v, dtype=torch.float32, device=robot.device)[:, None] for v in (felt.force, felt.torque))
    robot.set_external_force_and_torque(force, torque, positions=robot.data.body_pos_w[:, [tool]], body_ids=[tool], is_global=True)
    robot.write_data_to_sim()                                                   # in every step, also with zeros

Genesis (w first; torque about the origin of the link)::

    link = robot.get_link("tool")
    felt = sensor.step(dt, link.get_pos().cpu().numpy(), link.get_quat().cpu().numpy())
    scene.sim.rigid_solver.apply_links_external_force(felt.force[:, None], [link.idx], ref="link_origin")
    scene.sim.rigid_solver.apply_links_external_torque(felt.torque[:, None], [link.idx], ref="link_origin")
    scene.step()

ROS 2 (w last; a WrenchStamped is about the origin of its frame, so state the frame in which you publish)::

    p, q = pose.position, pose.orientation                                      # of the tool, in the frame "world"
    felt = sensor.step(dt, [p.x, p.y, p.z], [q.w, q.x, q.y, q.z], about=[0, 0, 0])
    message = WrenchStamped(header=Header(stamp=node.get_clock().now().to_msg(), frame_id="world"))
    (message.wrench.force.x, message.wrench.force.y, message.wrench.force.z) = felt.force.tolist()
    (message.wrench.torque.x, message.wrench.torque.y, message.wrench.torque.z) = felt.torque.tolist()

SOFA (Rigid3d: x, y, z, then the quaternion with w last; often millimetres: metres=0.001, with masses in kg)::

    def onAnimateBeginEvent(self, event):                                       # of a Sofa.Core.Controller
        x = self.tool.position.value[0]
        felt = sensor.step(event["dt"], x[:3], np.roll(x[3:], 1))
        with self.field.forces.writeable() as forces:                           # of a ConstantForceField on the tool
            forces[0] = [*felt.force, *felt.torque]
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from ._library import ByValue, Numbers
from .contact import ContactOptions
from .contacts import Contacts, Touches
from .dataset import Dataset

if TYPE_CHECKING:
    import numpy.typing as npt

    Pose = Tuple[npt.ArrayLike, Optional[npt.ArrayLike]]

RATE = 1000.0  # Hz, of contact updates: what the limits of sliding are made for
STRIDE = 0.0005  # m, longest motion of a tool per contact update
FASTEST = 5.0  # m/s; a tool that moves faster was placed elsewhere by a reset
LONGEST_STEP = 0.1  # s
SMALLEST, LARGEST = 0.001, 5.0  # m, size of an organ


@dataclass(frozen=True, eq=False)
class Wrench(ByValue):
    """Force and torque of the tissue after a time step, in the frame and units of the engine. Of n tools, row i is that of tool i.

    With ``metres`` = 1, forces are in N, torques in N m and energies in J. Else they are in the engine's units for masses in kg
    and times in s: with centimetres, forces are in kg cm/s^2 = 0.01 N."""

    force: Numbers  #: (3,), on the tool
    torque: Numbers  #: (3,), on the tool, about ``about``
    organ_force: Numbers  #: (3,), on the organ: -force
    organ_torque: Numbers  #: (3,), on the organ, about its origin, so that no momentum is created
    point: Numbers  #: (3,), where both forces act: the tip of the tool
    error_bound: Any  #: of the force, see ``Touch``; NaN: unknown
    touching: Any  #: bool
    inside: Any  #: bool, see ``Touch``; False also for a pose that is not finite
    jumped: Any  #: bool: the tool moved faster than 5 m/s. Its contact ended; it must come from outside again
    gap: Any  #: without contact: distance to the organ, negative inside it
    energy: Any  #: stored in the tissue
    work: Any  #: that the tool has done on the tissue since the start; work - energy was lost to friction


class Sensor:
    """Tools with a round tip that touch an organ in the world of a physics engine.

        sensor = palpate.Sensor(dataset, organ=([0.5, 0, 0.8], [1, 0, 0, 0]))
        while engine.runs():
            felt = sensor.step(dt, tool_position, tool_quaternion)
            engine.apply(tool, felt.force, felt.torque)     # about the tool's origin
            engine.step(dt)

    A pose is (position, rotation): the origin of a body in the engine's unit of length, and how its axes lie in the world, as a
    quaternion (w, x, y, z), of any length, or a 3 x 3 matrix whose columns are the axes; None: as those of the world.

    A contact is updated at least 1000 times per second and every 0.5 mm on a straight line from the last position, so engines may
    take long steps. The tissue has no mass and no viscosity. One thread at a time. Keeps its dataset in memory.
    """

    def __init__(self, dataset: Dataset, count: int | None = None, *, organ: Pose = ((0, 0, 0), None), metres: float = 1.0,
                 mirror: str = "", tip: npt.ArrayLike = (0, 0, 0), options: ContactOptions | None = None,
                 threads: int = 0) -> None:
        """count: number of tools; None: one, whose wrench has no leading dimension.
        organ: pose of the frame of the dataset, for engines that do not move the organ.
        metres: per unit of length of the engine: 0.01 for centimetres.
        mirror: for engines with left-handed axes: the axis, "x", "y" or "z", whose sign their import of the organ's mesh changed.
        tip: centre of the tip in the frame of the tool, engine units.
        options, threads: as of ``Contacts``."""
        size = float(np.ptp(dataset.vertices, axis=0).max())
        if not SMALLEST <= size <= LARGEST:
            raise ValueError(f"{dataset.file}: the organ is {size:.3g} m long; build it again with the length_unit of its mesh")
        if not 0 < metres < np.inf:
            raise ValueError(f"metres is {metres}; it must be the length of the engine's unit in metres, 0.01 for centimetres")
        if mirror not in ("", "x", "y", "z"):
            raise ValueError(f"mirror is {mirror!r}; it must be the axis x, y or z, or empty for right-handed engines")
        self._one = count is None
        self._contacts = Contacts(dataset, 1 if count is None else count, options, threads=threads)
        self._metres, self._tip = metres, np.asarray(tip, np.float64)
        self._mirror = np.array([-1.0 if axis == mirror else 1.0 for axis in "xyz"])
        with np.errstate(invalid="ignore"):
            self._turn, self._place = self._pose(organ, "the organ's")
        if not (np.isfinite(self._turn).all() and np.isfinite(self._place).all()):
            raise ValueError("the organ's pose is not finite, or its quaternion is zero")
        self._out: Touches | None = None
        self._last = np.full((len(self), 3), np.nan)
        self._force, self._work = np.zeros((len(self), 3)), np.zeros(len(self))
        self._text = f"<palpate.Sensor of {len(self)} on {dataset.name!r}, which is {size / metres:.3g} engine units long>"

    def __len__(self) -> int:
        return len(self._contacts)

    def __repr__(self) -> str:
        return self._text

    def step(self, dt: float, position: npt.ArrayLike, rotation: npt.ArrayLike | None = None, *, organ: Pose | None = None,
             about: npt.ArrayLike | None = None) -> Wrench:
        """Moves the tools to their poses at the end of a time step, and returns what they feel there. Apply it in the next step.

        dt: s, since the last call.
        position, rotation: pose of the tool, or (n, 3) and (n, 4) or (n, 3, 3).
        organ: its pose, if the engine moves it; for n tools one, or one for each.
        about: (3,) or (n, 3), reference point of the torque; default: the tool's origin.
        A tool whose pose is not finite feels nothing, with ``inside`` False; the others go on.
        """
        if not 0 < dt <= LONGEST_STEP:
            raise ValueError(f"dt is {dt}; it must be the engine's time step in seconds, at most {LONGEST_STEP}")
        with np.errstate(invalid="ignore", divide="ignore"):  # poses that are not finite
            wrench = self._wrench(dt, (position, rotation), organ, about)
        return Wrench(**{field.name: getattr(wrench, field.name)[0] for field in fields(wrench)}) if self._one else wrench

    def release(self, which: npt.ArrayLike = True) -> None:
        """Restarts all tools, or those where ``which``, (n,), is True: for environments that are reset."""
        mask = np.broadcast_to(np.asarray(which, np.bool_), (len(self),))
        self._contacts.release(mask)
        self._last[mask], self._force[mask], self._work[mask] = np.nan, 0, 0

    def _wrench(self, dt: float, tool: Pose, organ: Pose | None, about: npt.ArrayLike | None) -> Wrench:
        tool_turn, origin = self._pose(tool, "the tool's")
        turn, place = (self._turn, self._place) if organ is None else self._pose(organ, "the organ's")
        point = origin + _turned(tool_turn, self._tip)
        here = self._metres * self._mirror * _turned(turn.swapaxes(1, 2), point - place)
        touches, jumped = self._advance(dt, here)

        unit = 1 / self._metres
        force = unit * _turned(turn, self._mirror * touches.force)
        arm = point - (origin if about is None else self._rows(about, "about"))
        lost = ~np.isfinite(here).all(axis=1, keepdims=True)
        torque, organ_torque = (np.where(lost, 0, np.cross(a, f)) for a, f in ((arm, force), (point - place, -force)))
        force = np.where(lost, 0, force)
        return Wrench(force, torque, -force, organ_torque, point, unit * touches.error_bound, touches.touching.copy(),
                      touches.inside.copy(), jumped, unit * touches.gap, unit**2 * touches.energy, unit**2 * self._work)

    def _advance(self, dt: float, here: Numbers) -> tuple[Touches, npt.NDArray[np.bool_]]:
        """Moves the tips to ``here``, m, in the frame of the organ. Returns the touches, and which tips have jumped."""
        length = np.linalg.norm(here - self._last, axis=1)
        jumped = length > FASTEST * dt
        if jumped.any():
            self._contacts.release(jumped)
        starts = jumped | ~np.isfinite(length)
        way = np.where(starts[:, None], 0, here - self._last)
        strides = max(1, int(np.ceil(dt * RATE - 1e-6)), int(np.ceil(np.linalg.norm(way, axis=1).max() / STRIDE)))
        for stride in range(1, strides + 1):
            touches = self._out = self._contacts.update(here - (1 - stride / strides) * way, out=self._out)
            self._work -= np.einsum("ni,ni->n", self._force + touches.force, way) / (2 * strides)
            self._force[:] = touches.force
        self._last = here
        return touches, jumped

    def _pose(self, pose: Pose, whose: str) -> tuple[Numbers, Numbers]:
        """Returns rotation matrices and positions, one or n rows; NaN where a quaternion is not finite or zero."""
        position, rotation = pose
        place = self._rows(position, f"{whose} position")
        if rotation is None:
            return np.eye(3)[None], place
        turn = np.asarray(rotation, np.float64)
        if turn.shape[-1:] == (4,):
            turn = _matrices(turn.reshape(-1, 4))
        elif turn.shape[-2:] == (3, 3):
            turn = turn.reshape(-1, 3, 3)
            finite = turn[np.isfinite(turn).all(axis=(1, 2))]
            if (np.linalg.det(finite) < 0).any():
                raise ValueError(f"{whose} rotation is a left-handed matrix; negate one axis, or use mirror= for left-handed engines")
            if not np.allclose(finite @ finite.swapaxes(1, 2), np.eye(3), atol=1e-3):
                raise ValueError(f"{whose} rotation has a scale or a shear; its columns must be perpendicular unit vectors")
        if turn.ndim != 3 or len(turn) not in (1, len(self)):
            raise ValueError(f"{whose} rotation must be a quaternion (w, x, y, z) or a 3 x 3 matrix, one or {len(self)}")
        return turn, place

    def _rows(self, values: npt.ArrayLike, what: str) -> Numbers:
        rows = np.atleast_2d(np.asarray(values, np.float64))
        if rows.shape not in ((1, 3), (len(self), 3)):
            raise ValueError(f"{what} has shape {np.shape(values)}; it must be x, y and z, of one or of {len(self)}")
        return np.broadcast_to(rows, (len(self), 3))


def facing_up(dataset: Dataset, point: npt.ArrayLike, metres: float = 1.0) -> tuple[Numbers, Numbers]:
    """Returns a pose of the organ, (position, rotation), with ``point`` of the surface, (3,), m, in the world's origin and the
    outward normal there along z. metres: as of ``Sensor``."""
    vertex = np.linalg.norm(dataset.vertices - np.asarray(point), axis=1).argmin()
    a, b, c = dataset.vertices[dataset.triangles[(dataset.triangles == vertex).any(axis=1)]].transpose(1, 0, 2)
    z = np.cross(b - a, c - a).sum(axis=0)
    z /= np.linalg.norm(z)
    x = np.cross([0, 1, 0] if abs(z[1]) < 0.9 else [0, 0, 1], z)
    x /= np.linalg.norm(x)
    rotation = np.stack([x, np.cross(z, x), z])
    return -rotation @ np.asarray(point) / metres, rotation


def _turned(turns: Numbers, vectors: Numbers) -> Numbers:
    turned: Numbers = (turns @ vectors[..., None])[..., 0]
    return turned


def _matrices(quaternions: Numbers) -> Numbers:
    """Returns the rotation matrices, (n, 3, 3), of quaternions (w, x, y, z)."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
    matrices: Numbers = rows.reshape(-1, 3, 3)
    return matrices
