"""A run says CONVERGED when the camera is where it was taught; where it cannot tell, SETTLED and what is not known."""

import numpy as np
import pytest

import aras_visual_servo as avs
from aras_visual_servo import Status
from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo.spatial import inverse, mean_pose, rotation_angle

NAME = "six_dof_points"
PLAIN = avs.load_scenario(NAME)
TWO_POINTS = {"servo.features": ["x1", "y1", "x3", "y3"], "servo.interaction": "current",
              "servo.gains_per_s": dict.fromkeys(("x1", "y1", "x3", "y3"), 2.0),
              "servo.thresholds": dict.fromkeys(("x1", "y1", "x3", "y3"), 0.0005)}


def camera(**changes):
    return {"sim.cameras": [{**PLAIN.sim["cameras"][0], **changes}]}


def small_target(inclined_otherwise_rad):
    outline = [[-0.062, -0.031], [0.062, -0.031], [0.048, 0.031], [-0.062, 0.028]]
    sine, cosine = np.sin(inclined_otherwise_rad), np.cos(inclined_otherwise_rad)
    model = {key: value for key, value in PLAIN.sim["scene"]["models"][0].items() if key != "file"}
    return {"sim.scene.models": [{**model, "outlines_m": [outline]}],
            "servo.interaction": "current", "servo.target_normal_C": [-0.8 * sine, 0.6 * sine, cosine]}


SETTLED = {"motions that two points do not tell": TWO_POINTS,
           "pixels inside or outside": {"vision.segmentation": "otsu"},
           "a few samples a pixel": camera(renderer="opengl", exact_targets=False),
           "sides that round alike": camera(width=240, dither=False),
           "a plane that lies otherwise": small_target(0.1745)}


def from_half_way(changes):
    goal, start = (PLAIN.experiment[place]["joints"] for place in ("goal", "start"))
    half = {joint: 0.5 * (goal[joint] + start[joint]) for joint in goal}
    return avs.run(avs.load_scenario(NAME, {**changes, "experiment.start": {"joints": half}}))


@pytest.mark.parametrize("what", SETTLED)
def test_what_the_images_leave_open_is_not_called_converged(what):
    record = from_half_way(SETTLED[what])
    judgement = avs.judge(record)
    assert judgement.settled and not judgement.converged, judgement.reason
    assert record.status[record.servo_rows[-1]] == Status.SETTLED


@pytest.mark.parametrize("size", [(320, 240), (240, 240), (160, 120)])
def test_images_of_any_size_are_converged_on_and_within_the_judge(size):
    judgement = avs.judge(from_half_way(camera(width=size[0], height=size[1])))
    assert judgement.converged and judgement.passed, judgement


@pytest.mark.parametrize("name", ["experiment_1", "experiment_2", "six_dof_points"])
def test_what_was_true_at_the_end_is_true_ten_seconds_later(name):
    scenario = avs.load_scenario(name)
    loop, taught = ServoLoop(scenario), []
    loop.start()
    while not loop.sequence.done:
        record = loop.step()[0]
        if record.phase == "teach":
            taught.append(loop.camera_pose())
    assert loop.sequence.result.status == Status.CONVERGED
    X_CgW, limits = inverse(mean_pose(np.array(taught))), scenario.experiment["judge"]
    for _ in range(300):
        loop.step()
        X = X_CgW @ loop.camera_pose()
        assert (np.abs(1e3 * X[:3, 3]) <= [limits[axis] for axis in ("x_mm", "y_mm", "z_mm")]).all()
        assert np.degrees(rotation_angle(X[:3, :3])) <= limits["angle_deg"]
