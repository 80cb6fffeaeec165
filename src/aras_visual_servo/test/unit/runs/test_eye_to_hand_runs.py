"""A camera that stands still sees what the arm carries: both arms, moments and a tag, judged by the target's place in
the camera."""
import numpy as np
import pytest

import aras_visual_servo as avs
from aras_visual_servo import judge, load_scenario, measures, ParameterError
from aras_visual_servo.spatial import inverse, rotation_angle
from aras_visual_servo_study.report.page import report_html
from aras_visual_servo_study.report.pictures import panel_title
from aras_visual_servo_study.report.report import summarise

#: What the scenarios promise. Dry friction leaves a few tenths of a millimetre, a tag's corners as much again.
MM_DEG = {"x_mm": 1.0, "y_mm": 1.0, "z_mm": 1.0, "angle_deg": 0.2}
#: The target is this far from its goal at the start at least: arriving is work that was done.
FAR_MM = 40.0

RECTANGLE = {"name": "target", "attached_to": "link6", "position_m": [0.0, 0.0, 0.06], "rpy_rad": [0.0, 0.0, 1.5707963],
             "outlines_m": [[[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]]],
             "board": {"size_m": [0.4, 0.3], "color_rgb": [230, 230, 230]}}
#: Half as wide as the scenarios' own cameras, so that a run takes two thirds of the time.
CAMERA = {"name": "camera", "frame": "stand_optical_frame", "width": 320, "height": 240, "horizontal_fov_rad": 1.41,
          "rate_hz": 30.0, "encoding": "rgb8", "dither": True}
HAND = {"robot.tip_link": "stand_optical_frame", "robot.target_link": "link6"}
SIX_MOMENTS = {**HAND, "sim.cameras": [CAMERA], "sim.scene.models": [RECTANGLE], "experiment.z_star_m": 0.629}
#: A tag on the gantry arm: away from straight down, where this arm loses a tilt.
GANTRY_TAG = {
    "robot.urdf": "package://aras_description/urdf/aras_arm.urdf",
    "robot.controllers": "package://aras_visual_servo/config/joint_controllers.yaml",
    "sim.initial_positions": {"gantry": 0.0, "J1": 0.0, "J2": 0.0, "J3": 0.0, "J5": 0.0, "J6": 0.0},
    "experiment.goal": {"joints": {"gantry": 0.05, "J1": 0.0, "J2": -0.5, "J3": 0.9, "J5": 0.0, "J6": 0.0}},
    "experiment.start": {"joints": {"gantry": -0.02, "J1": 0.15, "J2": -0.4, "J3": 0.8, "J5": 0.1, "J6": 0.2}}}
#: arm and features -> scenario and what is changed in it
RUNS = {"gantry arm, moments": ("eye_to_hand", {}), "gantry arm, tag": ("six_dof_eye_to_hand", GANTRY_TAG),
        "six axes, moments": ("six_dof_rectangle", SIX_MOMENTS), "six axes, tag": ("six_dof_eye_to_hand", {})}
POINTS = {"servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0}, "servo.thresholds": {"points4": 0.001}}
POSE = {"servo.features": ["tx", "ty", "tz", "rx", "ry", "rz"],
        "servo.gains_per_s": dict.fromkeys(("tx", "ty", "tz", "rx", "ry", "rz"), 2.0),
        "servo.thresholds": {**dict.fromkeys(("tx", "ty", "tz"), 0.0005), **dict.fromkeys(("rx", "ry", "rz"), 0.002)}}
#: Every law that works with a tag, beside `hybrid`, which is the scenario's.
LAWS = {"ibvs": {**POINTS, "servo.law": "ibvs", "servo.interaction": "current"},
        "ibvs at the goal": {**POINTS, "servo.law": "ibvs", "servo.interaction": "desired"},
        "pbvs": {**POSE, "servo.law": "pbvs"},
        "sliding": {**POINTS, "servo.law": "sliding",
                    "servo.sliding": {"switching_per_s": 0.5, "boundary": {"points4": 0.02}}},
        "qp": {**POINTS, "servo.law": "qp", "servo.interaction": "current", "servo.qp": {}},
        "mpc": {**POINTS, "servo.law": "mpc", "servo.interaction": "current", "servo.mpc": {}},
        "broyden": {**POINTS, "servo.law": "broyden"}}


def assert_arrives(record):
    judgement = judge(record)
    assert judgement.converged, judgement.reason
    for name, bound in MM_DEG.items():
        assert abs(judgement.final_error[name]) <= bound, (name, judgement.final_error)
    assert max(abs(judgement.initial_error[axis]) for axis in ("x_mm", "y_mm", "z_mm")) > FAR_MM


@pytest.mark.parametrize("name", RUNS)
def test_the_target_arrives_where_it_was_taught_in_the_camera(name):
    record = avs.run(load_scenario(*RUNS[name]))
    assert_arrives(record)
    assert (record.X_WC == record.X_WC[0]).all()  # the camera stood still
    goal, last = (inverse(record.X_WC[row]) @ record.target_poses[row] for row in
                  (record.rows("teach")[0], record.servo_rows[-1]))
    assert 1e3 * np.linalg.norm(last[:3, 3] - goal[:3, 3]) < 1.8
    assert np.degrees(rotation_angle(goal[:3, :3].T @ last[:3, :3])) < MM_DEG["angle_deg"]


def test_the_report_shows_what_moved():
    record = avs.run(load_scenario("eye_to_hand", {"servo.time_limit_s": 0.2}))
    assert panel_title(record, "path") == "path of the target"
    page = report_html(record, summarise(record))
    assert "Final pose of the target" in page and "path of the target in the world" in page
    moved = np.linalg.norm(np.diff(record.target_poses[record.servo_rows][:, :3, 3], axis=0), axis=1).sum()
    assert measures(record, *np.full((2, 6), np.inf))["path_mm"] == pytest.approx(1e3 * moved)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_brings_the_tag_home(law):
    assert_arrives(avs.run(load_scenario("six_dof_eye_to_hand", {**LAWS[law], "sim.cameras": [CAMERA]})))


@pytest.mark.parametrize("scenario, changes, fault", [
    ("eye_to_hand", {"robot.target_link": "link5"}, r"attached_to: found link6, allowed link5"),
    ("eye_to_hand", {"servo.feed_forward": {"acceleration_m_s2": 0.5, "acceleration_rad_s2": 1.0}},
     "servo.feed_forward: .*target_link"),
    ("six_dof_qp", {**HAND, "sim.cameras": [CAMERA], "sim.scene.models": [RECTANGLE]}, "servo.qp.walls: found"),
    ("six_dof_photometric", {**HAND, "sim.cameras": [CAMERA], "sim.scene.models": [RECTANGLE]},
     "servo.features: .*target_link")])
def test_what_has_no_meaning_there_is_refused_when_the_scenario_is_loaded(scenario, changes, fault):
    with pytest.raises(ParameterError, match=fault):
        load_scenario(scenario, changes)
