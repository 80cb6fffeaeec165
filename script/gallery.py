"""Pictures of README.md and docs/: the arm seen from outside, and the six panels of the published experiments."""
import pathlib
import shutil
import sys
import tempfile

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from aras_visual_servo_controller.experiment import run_in_process
from aras_visual_servo_controller.report import save_results
from aras_visual_servo_controller.scenario import load_scenario, package_paths
from aras_visual_servo_sim import Simulation

EYE_W, LOOK_AT_W = np.array([1.75, -1.75, 1.35]), np.array([0.05, 0.05, 0.86])   # observer [m]
FLOOR = {"name": "floor", "outlines_m": [[[-6.0, -6.0], [6.0, -6.0], [6.0, 6.0], [-6.0, 6.0]]],
         "color_rgb": [204, 208, 214], "position_m": [0.0, 0.0, 0.0], "rpy_rad": [0.0, 0.0, 0.0]}
TABLE = {"name": "table", "outlines_m": [[[-0.42, -0.55], [0.42, -0.55], [0.42, 0.55], [-0.42, 0.55]]],
         "color_rgb": [236, 236, 232], "position_m": [0.03, 0.0, 0.192], "rpy_rad": [0.0, 0.0, 0.0]}


def looking(eye, at):
    """Quaternion-free rpy of a camera frame at `eye` that looks at `at`, world z up in the picture."""
    z = (at - eye) / np.linalg.norm(at - eye)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    return Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z])).as_euler("xyz")


def observer_picture(joints, path):
    """The arm at `joints` over its target, from a camera that stands beside it."""
    scenario = load_scenario("experiment_1")
    rpy = looking(EYE_W, LOOK_AT_W)
    stand = ('<link name="observer"/><joint name="observer_stand" type="fixed"><parent link="world"/>'
             '<child link="observer"/><origin xyz="%g %g %g" rpy="%.9g %.9g %.9g"/></joint></robot>'
             % (*EYE_W, *rpy))
    config = dict(scenario.sim, cameras=[{
        "name": "observer", "frame": "observer", "width": 960, "height": 720, "horizontal_fov_rad": 0.95,
        "rate_hz": 30.0, "near_m": 0.05, "far_m": 20.0}])
    config["scene"] = dict(scenario.sim["scene"], background_rgb=[226, 231, 238])
    config["scene"]["models"] = [FLOOR, TABLE, *config["scene"]["models"]]
    sim = Simulation(scenario.urdf_xml().replace("</robot>", stand), config, scenario.controllers(), package_paths())
    sim.set_joint_positions(joints)
    cv2.imwrite(str(path), cv2.cvtColor(sim.render("observer"), cv2.COLOR_RGB2BGR))


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    observer_picture(load_scenario("experiment_1").experiment["start"]["joints"], folder / "arm.png")
    for name in ("experiment_1", "experiment_1_paper", "experiment_2"):
        with tempfile.TemporaryDirectory() as results:
            save_results(run_in_process(load_scenario(name)), pathlib.Path(results))
            shutil.copy(pathlib.Path(results) / "figure.png", folder / f"{name}.png")
    print("\n".join(sorted(str(path) for path in folder.glob("*.png"))))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
