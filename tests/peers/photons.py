"""Images of an evenly lit sensor, for programs without ROS: asked on the standard input, as JSON,
{"sensor": keys, "width", "height", "file", "points": [{"exposure_s", "photons", "frames", "seed"}]}; `file` gets
(frames, height, width) of each point, in their order, as arrays of NumPy's npz. `photons` is 0 for a dark image."""
import json
import pathlib
import sys

import numpy as np
from aras_visual_servo_sim import Simulation

ROBOT = pathlib.Path(__file__).resolve().parents[2] / "src/aras_visual_servo_sim/test/ros/robot/pan_lift.urdf"


def images(asked, point):
    lit = point["photons"] > 0
    camera = {"name": "camera", "frame": "eye_optical_frame", "width": asked["width"], "height": asked["height"],
              "horizontal_fov_rad": 1.0, "encoding": "mono8", "rate_hz": 20.0, "exposure_samples": 1,
              "exposure_s": point["exposure_s"],
              "sensor": {**asked["sensor"], **({"white_photons": point["photons"]} if lit else {})}}
    simulation = Simulation(ROBOT.read_text(), {"cameras": [camera], "seed": point["seed"], "gravity_m_s2": [0, 0, 0],
                                                "scene": {"background_rgb": 3 * [255 if lit else 0]}}, {})
    for _ in range(point["frames"]):
        simulation.step_to_image("camera")
        yield simulation.render("camera").copy()


if __name__ == "__main__":
    request = json.load(sys.stdin)
    np.savez(request["file"], *(np.array(list(images(request, point))) for point in request["points"]))
    json.dump({}, sys.stdout)
