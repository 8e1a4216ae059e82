#!/usr/bin/env python3
"""Presses an ultrasound probe onto an organ with a constant force, and sweeps it 5 mm to each side.

    probe.py DATASET.h5 X Y Z [NEWTONS]

X Y Z is a place on the surface, m. The controller knows only the measured force: along the normal of that place, the probe moves
at a speed proportional to the force that is missing.
"""

import sys

import numpy as np

import palpate

STEP = 0.002  # s, of the controller
DAMPING = 20.0  # N s/m: missing force for a speed of 1 m/s
FASTEST = 0.02  # m/s, before the probe touches
SETTLE, SWEEP, AMPLITUDE = 2.0, 6.0, 0.005  # s, s, m


def main(file, place, wanted):
    dataset = palpate.Dataset(file)
    options = palpate.Contact.defaults(dataset)
    options.friction = 0.02  # gel
    sensor = palpate.Sensor(dataset, organ=palpate.facing_up(dataset, place), options=options)
    depth, missing = -0.002, []
    for step in range(round((SETTLE + SWEEP) / STEP)):
        time = step * STEP
        aside = AMPLITUDE * np.sin(2 * np.pi * max(0, time - SETTLE) / SWEEP)
        felt = sensor.step(STEP, [aside, 0, -depth])
        depth += STEP * min((wanted - felt.force[2]) / DAMPING, FASTEST)
        if time >= SETTLE:
            missing.append(wanted - felt.force[2])
            if not felt.touching:
                sys.exit(f"the probe slid off the organ after {time:.2f} s")
        if step % round(0.5 / STEP) == 0:
            print(f"{time:4.1f} s  {1e3 * aside:6.2f} mm aside  {1e3 * depth:6.2f} mm deep  {felt.force[2]:7.4f} N"
                  f" +- {felt.error_bound:.4f}" + ("" if felt.inside else "  deeper than computed"))
    print(f"worst deviation while sweeping: {np.abs(missing).max():.4f} N")


if __name__ == "__main__":
    if len(sys.argv) not in (5, 6):
        sys.exit("usage: probe.py DATASET.h5 X Y Z [NEWTONS]")
    main(sys.argv[1], [float(word) for word in sys.argv[2:5]], float(sys.argv[5]) if len(sys.argv) == 6 else 3.0)
