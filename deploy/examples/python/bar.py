#!/usr/bin/env python3
"""Presses a bar with two finger tips into an organ, and rocks it: a tool with an orientation, which feels a torque.

    bar.py SCENE.toml X Y Z [LENGTH_MM]

X Y Z is a place on the surface, m, above which the middle of the bar comes down along -z.
"""

import sys
import time

import numpy as np

import palpate


class Bar:
    """A rigid bar whose two tips stick to the body. A live solver follows one tip, while the other one holds the body."""

    def __init__(self, live, length):
        options = palpate.Contact.defaults(live.dataset)
        options.friction = 10
        self.live, self.reach = live, length / 2
        self.followed = palpate.Contact(live.dataset, options, live=live)
        self.holding = palpate.Contact(live.dataset, options)

    def update(self, middle, axis):
        """Moves the bar: its middle, m, and its direction, a unit vector. Returns the forces on its tips, (2, 3), N, and the torque
        on the bar about its middle, N m. Until the first tip touches and the live solver has answered, the force on the second one
        is that of a single finger in the dataset, or of a guess without one."""
        arms = np.outer((self.reach, -self.reach), axis)
        held = self.holding.update(middle + arms[1])
        if held.touching:
            self.live.hold(held.anchor, held.displacement)
        else:
            self.live.let_go()
        force = self.followed.update(middle + arms[0]).force
        exact = self.live.hold_force
        forces = np.array((force, held.force if np.isnan(exact).any() else exact))
        return forces, np.cross(arms, forces).sum(axis=0)

    def close(self):
        self.live.let_go()
        self.followed.close()
        self.holding.close()


def main(scene, place, length):
    with palpate.Live(scene) as live:
        bar = Bar(live, length)
        for step in range(4001):
            angle = np.radians(6) * np.sin(2 * np.pi * max(0, step - 1000) / 3000)
            middle = np.array(place) + [0, 0, max(0.003 - 6e-6 * step, -0.003)]
            forces, torque = bar.update(middle, (np.cos(angle), 0, np.sin(angle)))
            if step % 250 == 0:
                print(f"{np.degrees(angle):5.1f} degrees  {np.linalg.norm(forces.sum(axis=0)):6.3f} N  {1e3 * torque[1]:7.3f} mN m")
            time.sleep(0.001)
        bar.close()


if __name__ == "__main__":
    if len(sys.argv) not in (5, 6):
        sys.exit("usage: bar.py SCENE.toml X Y Z [LENGTH_MM]")
    main(sys.argv[1], [float(word) for word in sys.argv[2:5]], 1e-3 * float(sys.argv[5] if len(sys.argv) == 6 else 50))
