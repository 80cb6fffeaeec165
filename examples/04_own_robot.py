"""A robot of one's own, from its URDF: a SCARA with a camera that looks down.   python3 examples/04_own_robot.py"""
from pathlib import Path

import numpy as np

import aras_visual_servo as avs

FOLDER = Path(__file__).parent / "scara"

scenario = avs.load_scenario(FOLDER / "scara.yaml")  # names scara.urdf and its joint controllers
arm = avs.kinematics_of(scenario.urdf_xml(), scenario.robot)
goal = arm.pose(scenario.goal_posture(arm))  # X_BC, camera in the base; the target lies on the optical axis
print("joints", ", ".join(arm.joint_names))
print("target at", np.round(goal[:3, 3] + scenario.experiment["z_star_m"] * goal[:3, 2], 4), "m")

record = avs.run(scenario)
result = avs.judge(record)
print("passed" if result.passed else "failed", f"after {result.duration_s:.2f} s", result.final_error)
