#!/usr/bin/env python3
"""A robot finger palpates a soft body. DART simulates a finger with three joints, Palpate computes the tissue's force on its tip,
and the force acts on the joints.

    palpation.py DATASET.h5 [DEPTH_MM]

Needs python3-dartpy and the package of docs/python.md. DART's own contacts are not used: its soft bodies are springs between
points. Palpate's force comes from precomputed equilibria of the body and has an error bound in newtons.
"""

import sys

import dartpy as dart
import numpy as np

import palpate

LINK = 0.1  # m, length of each of the two links
REACH, HEIGHT = 0.08, 0.12  # m, from the base to the touched point
STIFFNESS, DAMPING = 500.0, 6.0  # N/m and N s/m, of the controller at the tip
START = 0.002  # m, above the surface
DURATION, PRINT_EVERY = 4.0, 0.1  # s
END = np.array([LINK, 0.0, 0.0])  # end of a link, in its own frame


def outward_normal(dataset, vertex):
    """Returns the mean outward unit normal of the triangles at a vertex."""
    a, b, c = dataset.vertices[dataset.triangles[(dataset.triangles == vertex).any(axis=1)]].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a).sum(axis=0)
    return normal / np.linalg.norm(normal)


def isometry(rotation, translation):
    made = dart.math.Isometry3()
    made.set_rotation(rotation)
    made.set_translation(translation)
    return made


def finger(place, normal):
    """Returns a finger with three joints, elbow up. Its base is HEIGHT above the place, its tip START above it."""
    aside = np.eye(3)[int(abs(normal[0]) >= 0.9)]
    x = aside - normal * (normal @ aside)
    x /= np.linalg.norm(x)
    base = isometry(np.stack([x, np.cross(normal, x), normal], axis=1), place + HEIGHT * normal - REACH * x)

    skeleton, parent = dart.dynamics.Skeleton("finger"), None
    for name, axis, before, length in (("turn", [0, 0, 1], base, 0), ("shoulder", [0, 1, 0], dart.math.Isometry3(), LINK),
                                       ("elbow", [0, 1, 0], isometry(np.eye(3), END), LINK)):
        joint, body = skeleton.createRevoluteJointAndBodyNodePair(parent)
        joint.setName(name)
        body.setName("link of " + name)
        joint.setAxis(axis)
        joint.setTransformFromParentBodyNode(before)
        mass = 0.012 if length else 0.001  # kg, for a rod of this length
        body.setInertia(dart.dynamics.Inertia(mass, [length / 2, 0, 0], np.diag([1e-6, *2 * [1e-6 + mass * length**2 / 12]])))
        parent = body
    down = HEIGHT - START
    distance = np.hypot(REACH, down)
    bend = np.arccos(distance / 2 / LINK)
    skeleton.setPositions([0, np.arctan2(down, REACH) - bend, 2 * bend])
    return skeleton


def main(file, depth):
    dataset = palpate.Dataset(file)
    contact = palpate.Contact(dataset)
    place = dataset.spaces[0].rest_position
    normal = outward_normal(dataset, dataset.spaces[0].vertex)
    skeleton = finger(place, normal)
    world = dart.simulation.World()
    world.addSkeleton(skeleton)
    world.setTimeStep(0.001)
    tip = skeleton.getBodyNode(skeleton.getNumBodyNodes() - 1)

    print("#  time   depth      force of the tissue, N           felt in the joints, N            |error| <")
    for step in range(round(DURATION / world.getTimeStep())):
        x = tip.getWorldTransform().multiply(END)
        touch = contact.update(x)  # force of the tissue on the tip
        tip.addExtForce(touch.force, END)

        # Control the tip with a spring and a damper; its target moves in and out along the normal.
        # Also compensate gravity.
        jacobian = skeleton.getLinearJacobian(tip, END)
        inward = depth * 0.5 * (1 - np.cos(2 * np.pi * world.getTime() / DURATION)) - START
        pull = STIFFNESS * (place - inward * normal - x) - DAMPING * jacobian @ skeleton.getVelocities()
        bias = skeleton.getCoriolisAndGravityForces()
        torque = jacobian.T @ pull + bias
        skeleton.setForces(torque)

        if step % round(PRINT_EVERY / world.getTimeStep()) == 0:
            # Estimate the force from the torques, as a robot without a force sensor does.
            felt = np.linalg.solve(jacobian.T, bias - torque)
            print(f"{world.getTime():7.3f} {1e3 * (place - x) @ normal:7.3f}  " + " ".join(f"{f:9.4f}" for f in touch.force)
                  + "   " + " ".join(f"{f:9.4f}" for f in felt) + f"   {touch.error_bound:9.2g}"
                  + ("  touching" if touch.touching else ""))
        world.step()


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: palpation.py DATASET.h5 [DEPTH_MM]")
    main(sys.argv[1], 1e-3 * float(sys.argv[2] if len(sys.argv) > 2 else 8))
