#!/usr/bin/env python3
"""Wall time from the start of the process to the first image, and resident memory after it, of the simulator in Python.

    python3 start_up.py            a flat target in view
    python3 start_up.py --solid    a solid in view too
    python3 start_up.py --opengl   with a solid, drawn by OpenGL, its compiled shaders at hand
    python3 start_up.py --blind    no camera at all
"""
import argparse
import os
import time

PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


def process_age_s():
    """Since the kernel started this process, so the interpreter counts too."""
    with open("/proc/self/stat", encoding="ascii") as stat:
        started_ticks = int(stat.read().rsplit(")", 1)[1].split()[19])
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started_ticks / os.sysconf("SC_CLK_TCK")


def resident_mib():
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * PAGE_BYTES / 2**20


def make_simulation(solid=False, camera=True, renderer="coverage"):
    """The arm over a flat target, which its camera sees; with a solid in view too if told."""
    from aras_visual_servo_sim import Simulation
    config = {"scene": {"models": [{"name": "target", "file": "package://aras_description/targets/blob.yaml",
                                    "position_m": [0.03, 0.05, 0.19]}]}}
    if solid:
        config["scene"]["solids"] = [{"name": "ball", "sphere_m": 0.05, "position_m": [0.05, 0.05, 0.2]}]
    if camera:
        config["cameras"] = [{"name": "camera", "frame": "camera_optical_frame", "width": 320, "height": 240,
                              "horizontal_fov_rad": 1.41, "renderer": renderer}]
    return Simulation("package://aras_description/urdf/aras_arm.urdf", config)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--solid", action="store_true")
    parser.add_argument("--opengl", action="store_true")
    parser.add_argument("--blind", action="store_true")
    options = parser.parse_args()
    simulation = make_simulation(options.solid or options.opengl, not options.blind,
                                 "opengl" if options.opengl else "coverage")
    if not options.blind:
        simulation.render("camera")
    print(f"resident {resident_mib():.1f} MiB, seconds since the start: {process_age_s():.2f}")


if __name__ == "__main__":
    main()
