#!/usr/bin/env python3
"""A robot finger palpates a soft body. DART simulates a finger with three joints, Palpate computes the tissue's force on its tip,
and the force acts on the joints.

    palpation.py DATASET.h5 [DEPTH_MM]

Needs python3-dartpy and the package of docs/python.md. DART's own contacts are not used: its soft bodies are springs between
points. Palpate's force comes from precomputed equilibria of the body and has an error bound in newtons. ``palpate_with`` is all
that a simulation of your own needs.
"""

import sys

import dartpy as dart
import numpy as np

import palpate

LINK = 0.1  # m, length of each of the two links
REACH, HEIGHT = 0.08, 0.12  # m, from the base to the touched point
STIFFNESS, DAMPING = 500.0, 6.0  # N/m and N s/m, of the controller at the tip
START = 0.002  # m, above the surface
DURATION, STEP, PRINT_EVERY = 4.0, 0.001, 0.1  # s
END = np.array([LINK, 0.0, 0.0])  # end of a link, in its own frame


def moved(translation):
    made = dart.math.Isometry3()
    made.set_translation(translation)
    return made


class Robot:
    """A finger with three joints, elbow up, and its controller. The touched point is the origin, and its normal is z."""

    def __init__(self):
        self.skeleton, parent = dart.dynamics.Skeleton("finger"), None
        for name, axis, before, length in (("turn", [0, 0, 1], moved([-REACH, 0, HEIGHT]), 0),
                                           ("shoulder", [0, 1, 0], moved([0, 0, 0]), LINK), ("elbow", [0, 1, 0], moved(END), LINK)):
            joint, parent = self.skeleton.createRevoluteJointAndBodyNodePair(parent)
            joint.setName(name)
            parent.setName("link of " + name)
            joint.setAxis(axis)
            joint.setTransformFromParentBodyNode(before)
            mass = 0.012 if length else 0.001  # kg, for a rod of this length
            parent.setInertia(dart.dynamics.Inertia(mass, [length / 2, 0, 0],
                                                    np.diag([1e-6, *2 * [1e-6 + mass * length**2 / 12]])))
        self.tip = parent
        distance = np.hypot(REACH, HEIGHT - START)
        bend = np.arccos(distance / 2 / LINK)
        self.skeleton.setPositions([0, np.arctan2(HEIGHT - START, REACH) - bend, 2 * bend])
        self.world = dart.simulation.World()
        self.world.setGravity([0, 0, -9.81])
        self.world.addSkeleton(self.skeleton)
        self.world.setTimeStep(STEP)
        self.torque, self.angles = np.zeros(3), self.skeleton.getPositions()
        self.motors, self.worst, self.most = self.energy(), 0.0, 0.0  # J

    def energy(self):
        # DART's computePotentialEnergy takes the origins of the links for their centres of mass.
        return self.skeleton.computeKineticEnergy() + 9.81 * self.skeleton.getMass() * self.skeleton.getCOM()[2]

    def control(self, target, felt):
        """Pulls the tip to a target with a spring and a damper. Returns the force on the tip that a robot without a sensor estimates
        from its torques. Accounts for energy: the motors' work becomes energy of the finger and work on the tissue."""
        jacobian = self.skeleton.getLinearJacobian(self.tip, END)
        pull = STIFFNESS * (target - felt.point) - DAMPING * jacobian @ self.skeleton.getVelocities()
        bias = self.skeleton.getCoriolisAndGravityForces()
        torque, before = jacobian.T @ pull + bias, self.torque
        self.skeleton.setForces(torque)
        angles = self.skeleton.getPositions()
        self.motors += 0.5 * (torque + before) @ (angles - self.angles)
        self.torque, self.angles = torque, angles
        self.worst = max(self.worst, abs(self.motors - self.energy() - felt.work))
        self.most = max(self.most, felt.energy)
        return np.linalg.solve(jacobian.T, bias - torque)


def palpate_with(robot, dataset, place, path):
    """Moves the tip along a path. Yields what the tissue does, and the force that the robot estimates."""
    sensor = palpate.Sensor(dataset, organ=palpate.facing_up(dataset, place), tip=END)  # the place is in the origin
    for target in path:
        pose = robot.tip.getWorldTransform()
        felt = sensor.step(STEP, pose.translation(), pose.rotation())
        robot.tip.addExtForce(felt.force, END)
        yield felt, robot.control(target, felt)
        robot.world.step()


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: palpation.py DATASET.h5 [DEPTH_MM]")
    dataset, robot = palpate.Dataset(sys.argv[1]), Robot()
    depth = 1e-3 * float(sys.argv[2] if len(sys.argv) > 2 else 8)
    times = STEP * np.arange(round(DURATION / STEP))
    path = np.outer(START - depth * 0.5 * (1 - np.cos(2 * np.pi * times / DURATION)), [0, 0, 1])
    print("#  time   depth      force of the tissue, N           felt in the joints, N            |error| <")
    for step, (felt, estimate) in enumerate(palpate_with(robot, dataset, dataset.spaces[0].rest_position, path)):
        if step % round(PRINT_EVERY / STEP) == 0:
            print(f"{times[step]:7.3f} {-1e3 * felt.point[2]:7.3f}  " + " ".join(f"{f:9.4f}" for f in felt.force) + "   "
                  + " ".join(f"{f:9.4f}" for f in estimate) + f"   {felt.error_bound:9.2g}" + ("  touching" if felt.touching else ""))
    print(f"# energy: {1e3 * robot.most:.4g} mJ stored in the tissue, at most {1e3 * robot.worst:.2g} mJ not accounted for")


if __name__ == "__main__":
    main()
