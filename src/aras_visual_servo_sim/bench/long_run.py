#!/usr/bin/env python3
"""Resident memory after 10^4 physics steps and after --steps (10^7), with a frame of 320 x 240 every hundred steps.

    python3 long_run.py            a flat target in view
    python3 long_run.py --solid    a solid in view too
"""
import argparse
import time

from start_up import make_simulation, resident_mib

STEPS_PER_FRAME = 100


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--solid", action="store_true")
    parser.add_argument("--steps", type=int, default=10**7)
    options = parser.parse_args()
    simulation, start = make_simulation(solid=options.solid), time.perf_counter()
    for frame in range(1, options.steps // STEPS_PER_FRAME + 1):
        simulation.step(STEPS_PER_FRAME)
        simulation.render("camera")
        if frame * STEPS_PER_FRAME in (10**4, options.steps):
            print(f"{frame * STEPS_PER_FRAME} steps, {frame} frames, {time.perf_counter() - start:.1f} s: "
                  f"{resident_mib():.2f} MiB", flush=True)


if __name__ == "__main__":
    main()
