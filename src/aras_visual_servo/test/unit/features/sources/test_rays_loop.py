"""A whole run through a fisheye 200 degrees wide: plates on a wall beside the camera, some behind its image plane."""

import numpy as np
import pytest

import aras_visual_servo as avs
from aras_visual_servo import judge, kinematics_of, load_scenario, ServoLoop
from aras_visual_servo.spatial import rpy_of

#: The wall is DISTANCE_M away along NORMAL, in the camera frame at the goal.
NORMAL, DISTANCE_M = np.array([0.95, 0.0, 0.3122499]), 0.45
#: Directions of the plates [deg]: from the optical axis, and about it.
PLATES = ((92.5, 18.0), (92.0, -22.0), (62.0, 26.0), (66.0, -20.0))
NAMES = tuple(f"{axis}s{number}" for number in (1, 2, 3, 4) for axis in "uvw")
SIDE = 0.03
#: Some centimetres and degrees from the goal, the plates less than 100 degrees from the axis.
START = {"gantry": 0.03, "J1": 0.0, "J2": -0.46, "J3": 0.86, "J4": 0.02, "J5": -0.4, "J6": 0.15}


def scenario():
    """`six_dof_rectangle` with the plates instead of its target."""
    base = load_scenario("six_dof_rectangle")
    arm = kinematics_of(base.urdf_xml(), base.robot)
    X_WC = arm.pose(arm.vector(base.experiment["goal"]["joints"]))
    x = np.array([0.0, 1.0, 0.0])
    R_CP = np.stack([x, np.cross(-NORMAL, x), -NORMAL], axis=1)  # the plates' faces look back at the camera
    models, rays = [], []
    for number, (from_axis, about) in enumerate(np.radians(PLATES)):
        s = np.array([np.sin(from_axis) * np.cos(about), np.sin(from_axis) * np.sin(about), np.cos(from_axis)])
        P_W = X_WC[:3, :3] @ (DISTANCE_M / (NORMAL @ s) * s) + X_WC[:3, 3]
        models.append({"name": "target" if number == 0 else f"plate_{number + 1}", "position_m": P_W.tolist(),
                       "rpy_rad": [float(angle) for angle in rpy_of(X_WC[:3, :3] @ R_CP)],
                       "outlines_m": [[[-SIDE, -SIDE], [SIDE, -SIDE], [SIDE, SIDE], [-SIDE, SIDE]]]})
        rays.append(s)
    middle = np.mean(rays, axis=0)
    return load_scenario("six_dof_rectangle", {
        "sim.scene.models": models, "experiment.start.joints": START,
        "sim.cameras": [{"name": "camera", "frame": "camera_optical_frame", "width": 480, "height": 480,
                         "rate_hz": 30.0, "fx_px": 130.0, "fy_px": 130.0, "encoding": "mono8",
                         "distortion_model": "equidistant",
                         "distortion": [0.01, -0.002, 0.0, 0.0], "sampling": "coverage", "near_m": 0.02, "far_m": 5.0}],
        "vision": {"object": "dark", "segmentation": "coverage", "object_grey": 20, "background_grey": 230,
                   "min_area_px": 30, "points": "blobs", "point_count": 4, "rays": True},
        "servo.features": list(NAMES), "servo.gains_per_s": dict.fromkeys(NAMES, 2.0), "servo.interaction": "current",
        "servo.thresholds": dict.fromkeys(NAMES, 0.0005), "servo.target_normal_C": NORMAL.tolist(),
        "experiment.z_star_m": float(DISTANCE_M / (NORMAL @ middle) * middle[2])})


def test_the_camera_comes_home_to_plates_beside_and_behind_it():
    pytest.importorskip("aras_visual_servo_sim")
    judgement = judge(avs.run(scenario()))
    assert judgement.passed, judgement.faults


def test_rays_point_to_the_plates_and_there_are_no_coordinates():
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(scenario())
    loop.place(loop.scenario.experiment["goal"]["joints"], settle_s=0.2)
    loop.step()
    seen = loop.servo_extractor.features
    assert seen.valid and len(seen.point_x) == 0 and min(seen.ray_z) < -0.03
    found = np.array([seen.ray_x, seen.ray_y, seen.ray_z]).T
    for name in ("target", "plate_2", "plate_3", "plate_4"):
        P = (np.linalg.inv(loop.camera_pose()) @ np.r_[loop.sim.model_pose(name)[:3, 3], 1.0])[:3]
        # the middle of a plate's image is not the image of its middle: 0.03^2 / (3 0.45^2) of its slant
        assert np.min(np.linalg.norm(found - P / np.linalg.norm(P), axis=1)) < 5e-3
