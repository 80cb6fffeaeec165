#!/usr/bin/env python3
"""Physics steps or camera frames per second of the simulator in Python, one core; the last word printed is the figure.

    python3 rates.py physics                  the arm with six PIDs and friction, its set-points moving
    python3 rates.py physics --urdf U --controllers C    the same of another robot (URDF and controllers' YAML)
    python3 rates.py camera [SCENE]           320 x 240 rgb8, the arm moving between frames, only rendering is timed
    python3 rates.py rolling [SCENE] --renderer opengl --height 480    a rolling shutter, the arm moving, by CPU time

SCENE, all of them filling the view: plane (default; a table of one colour and a flat target on it), picture (a photo),
lit (the table a box, shaded, and a flat target on it), boxes (plane, and ten shaded boxes on it).
"""
import argparse
import statistics
import time

import yaml

from aras_visual_servo_sim import Simulation

ARM = "package://aras_description/urdf/aras_arm.urdf"
GAINS = {  # the published ones
    "gantry": (15000.0, 5.0, 400.0), "J1": (3000.0, 40.0, 40.0), "J2": (7000.0, 1000.0, 165.0),
    "J3": (4000.0, 200.0, 0.0), "J5": (3500.0, 150.0, 0.0), "J6": (70.0, 2.0, 0.0)}
TABLE_Z_M = 0.19
GREY = [230, 225, 220]


def published_controllers():
    return {joint: {"type": "effort_controllers/JointPositionController", "joint": joint,
                    "pid": {"p": p, "i": i, "d": d, "i_clamp": 1000.0}} for joint, (p, i, d) in GAINS.items()}


def scene_of(name):
    """A table of 3 m x 4 m under the arm, of one colour, lit or a picture; boxes on it."""
    target = {"name": "target", "file": "package://aras_description/targets/rectangle.yaml",
              "position_m": [0.03, 0.05, TABLE_Z_M + 0.001], "rpy_rad": [0.0, 0.0, 0.35]}
    table = {"name": "table", "outlines_m": [[[-1.5, -2.0], [1.5, -2.0], [1.5, 2.0], [-1.5, 2.0]]], "color_rgb": GREY,
             "position_m": [0.0, 0.0, TABLE_Z_M]}
    if name == "plane":
        return {"models": [table, target]}
    if name == "picture":
        photo = {"file": "package://aras_description/targets/photo.png", "size_m": [1.6, 1.2]}
        return {"models": [{"name": "photo", "image": photo, "position_m": [0.03, 0.05, TABLE_Z_M]}]}
    if name == "lit":
        return {"models": [target], "solids": [{"name": "table", "box_m": [3.0, 4.0, 0.02], "color_rgb": GREY,
                                                "position_m": [0.0, 0.0, TABLE_Z_M - 0.01]}]}
    boxes = [{"name": f"box{k}", "box_m": [0.03, 0.02, 0.06], "color_rgb": [200, 120, 40],
              "position_m": [0.03 + 0.12 * (k % 5 - 2), 0.05 + 0.2 * (k // 5) - 0.1, TABLE_Z_M + 0.03],
              "rpy_rad": [0.0, 0.0, 0.4 * k]} for k in range(10)]
    return {"models": [table, target], "solids": boxes}


def physics(options):
    controllers = published_controllers()
    if options.controllers:
        with open(options.controllers, encoding="utf-8") as file:
            controllers = yaml.safe_load(file)
    simulation = Simulation(options.urdf, {}, controllers)
    wave = {joint: 0.1 for joint in simulation.joint_names}
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < options.seconds:
        wave = {joint: -velocity for joint, velocity in wave.items()}
        simulation.set_command(velocity=wave)
        simulation.step(500)
        steps += 500
    return steps / (time.perf_counter() - start), "steps/s"


def camera(options):
    simulation = Simulation(ARM, {"scene": scene_of(options.scene), "cameras": [
        {"name": "camera", "frame": "camera_optical_frame", "width": 320, "height": 240, "horizontal_fov_rad": 1.41}],
        "initial_positions": {"gantry": 0.05}}, published_controllers())
    times, stop, velocity = [], time.perf_counter() + options.seconds, 0.05
    while time.perf_counter() < stop:
        if len(times) % 200 == 0:
            velocity = -velocity
        simulation.set_command(velocity={"J2": velocity, "J6": 2.0 * velocity})
        simulation.step(5)  # the view moves: nothing can be kept from the frame before
        start = time.perf_counter()
        simulation.render("camera")
        times.append(time.perf_counter() - start)
    return 1.0 / statistics.median(times), "frames/s"


def rolling(options):
    height = options.height
    simulation = Simulation(ARM, {"scene": scene_of(options.scene), "cameras": [
        {"name": "camera", "frame": "camera_optical_frame", "width": height * 4 // 3, "height": height,
         "horizontal_fov_rad": 1.41, "rate_hz": 30.0, "renderer": options.renderer,
         "sensor": {"shot_noise": False, "row_time_s": 0.02 / height}}],
        "initial_positions": {"gantry": 0.05}}, published_controllers())
    simulation.set_command(velocity={"J2": 0.05, "J6": 0.1})
    times = []
    for _ in range(6):
        simulation.step_to_image()
        start = time.process_time()
        simulation.render("camera")
        times.append(time.process_time() - start)
    return 1.0 / statistics.median(times[1:]), "frames/s of CPU time"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["physics", "camera", "rolling"])
    parser.add_argument("scene", nargs="?", default="plane", choices=["plane", "picture", "lit", "boxes"])
    parser.add_argument("--urdf", default=ARM, help="robot of `physics`")
    parser.add_argument("--controllers", help="YAML of its controllers")
    parser.add_argument("--renderer", choices=["coverage", "opengl"], default="opengl", help="of `rolling`")
    parser.add_argument("--height", type=int, choices=[240, 480], default=240, help="of the image of `rolling` [px]")
    parser.add_argument("--seconds", type=float, default=1.0, help="how long to measure (default 1)")
    options = parser.parse_args()
    rate, unit = {"physics": physics, "camera": camera, "rolling": rolling}[options.what](options)
    print(f"{options.what} [{unit}]: {rate:.0f}" if rate > 100 else f"{options.what} [{unit}]: {rate:.1f}")


if __name__ == "__main__":
    main()
