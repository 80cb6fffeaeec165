"""What the page advises: the kind of each end, and what it names of the run."""

import numpy as np
import pytest

from aras_visual_servo import Status, kinematics_of, load_scenario, spatial
from aras_visual_servo_study.live.advice import TABLE, Moment, Seen, advice, limit_joint

ARM = kinematics_of(load_scenario("experiment_1").urdf_xml(), load_scenario("experiment_1").robot, calibrated=False)
REACH = "out of reach; in its own frame the camera would have to go on to the left and down, as seen in its image"
TIME = "not converged after 20.0 s: yn; for the last 3.0 s the arm could not follow the law ({})"
LIMIT = "joint 'J2' at its limit, speed times 0.43"


def told(status, text, phase="servo", q=(0.0,) * 6, seen=None):
    return advice(Moment(status, text, phase, ARM, np.array(q), (320, 240), seen))


@pytest.mark.parametrize("status, text, kind, named", [
    (Status.OUT_OF_REACH, REACH, "out_of_reach", "where its plane is green"),
    (Status.TIMED_OUT, TIME.format(REACH), "out_of_reach", "where its plane is green"),
    (Status.NEAR_SINGULARITY, "joint 'J5' chatters: it reverses from image to image", "chatters", "J5"),
    (Status.TIMED_OUT, TIME.format("joint 'J5' chatters: it reverses"), "chatters", "J5"),
    (Status.JOINT_LIMIT, LIMIT, "joint_limit", "J2"), (Status.TIMED_OUT, TIME.format(LIMIT), "joint_limit", "J2"),
    (Status.TIMED_OUT, TIME.format("at their limits, the others go on: J3, J1"), "joint_limit", "J3"),
    (Status.NEAR_SINGULARITY, "part of the twist cannot be achieved here", "singular", "J3 in its"),
    (Status.TARGET_LOST, "target not in view", "lost_target", "not seen since"),
    (Status.STOPPED, "target lost for 10 s", "lost_target_ended", ""),
    (Status.TIMED_OUT, "not converged after 20.0 s: xn", "timed_out", "servo.time_limit_s"),
    (Status.TIMED_OUT, "not converged after 20.0 s: everything for less than hold_s", "not_held", ""),
    (Status.TIMED_OUT, TIME.format("target cut by the border"), "lost_in_time_limit", "not seen since"),
    (Status.STOPPED, "stopped from the page", "stopped", ""), (Status.STALE_INPUT, "no image", "stale", ""),
    (Status.FAULT, "to_goal: joint 'J1' was sent to 1 and rests at 0", "held_at_end", "J1"),
    (Status.CONVERGED, "features, tilt and pose within their thresholds", "converged", ""),
    (Status.SETTLED, "arrived as far as these features tell", "settled", "")])
def test_each_end_has_its_kind_and_names_what_it_is_about(status, text, kind, named):
    found, now = told(status, text)
    assert found == kind and named in now and "{" not in now


@pytest.mark.parametrize("status, text", [
    (Status.OUT_OF_REACH, f"out of reach by 9 mm, {LIMIT}"), (Status.JOINT_LIMIT, LIMIT), (Status.SERVOING, "servoing"),
    (Status.TIMED_OUT, TIME.format(REACH)), (Status.TARGET_LOST, "target not in view")])
def test_a_camera_that_swings_is_named_before_what_came_of_it(status, text):
    moment = Moment(status, text, "servo", ARM, np.zeros(6), (320, 240), swings=True)
    assert advice(moment)[0] == "swings"


def test_while_all_goes_well_nothing_is_advised():
    assert told(Status.SERVOING, "servoing") == ("", "") and told(Status.IDLE, "to_goal", "to_goal") == ("", "")


def test_a_lost_target_is_told_with_where_it_was_seen():
    _, now = told(Status.TARGET_LOST, "target not in view", seen=Seen(310.0, 12.0))
    assert "top right" in now and "310, 12" in now


@pytest.mark.parametrize("way, turn, named", [
    ((0.0, -0.1, 0.02), 0.0, "back up in"), ((0.1, 0.09, 0.0), 0.0, "back to the right and down in"),
    ((0.0, 0.0, 0.1), 0.0, "back, to where"),
    ((0.0, 0.0, 0.0), 0.3, "ring"), ((0.0, 0.0, 0.0), 0.0, "to where its plane")])
def test_a_target_out_of_reach_is_dragged_back_on_its_plane(way, turn, named):
    away_C = spatial.pose_from_rpy(way, (0.0, 0.0, turn))
    assert named in advice(Moment(Status.OUT_OF_REACH, REACH, "servo", ARM, np.zeros(6), (320, 240), None, away_C))[1]


@pytest.mark.parametrize("status, text, joint", [
    (Status.JOINT_LIMIT, LIMIT, "J2"), (Status.OUT_OF_REACH, f"out of reach by 9 mm, {LIMIT}", "J2"),
    (Status.JOINT_LIMIT, "at their limits, the others go on: J3, J1", "J3"),
    (Status.JOINT_LIMIT, "at their limits, the others go on: joint 'J3', joint 'J1'", "J3"),
    (Status.JOINT_LIMIT, "braking, too late at the allowed acceleration: joint 'J5'", "J5"),
    (Status.NEAR_SINGULARITY, "joint 'J5' chatters", ""), (Status.OUT_OF_REACH, REACH, "")])
def test_the_joint_that_a_limit_holds_back_is_named(status, text, joint):
    assert limit_joint(status, TIME.format(text)) == limit_joint(status, text) == joint


def test_the_way_out_of_a_singularity_raises_the_smallest_singular_value():
    def least(q):
        return np.linalg.svd(np.diag([1 / 0.3] * 3 + [1.0] * 3) @ ARM.jacobian(q), compute_uv=False)[-1]

    q = np.array([0.0, -0.02, 0.01, 0.01, 0.0, 0.0])
    words = told(Status.NEAR_SINGULARITY, "part of the twist cannot be achieved here", q=q)[1].split()
    name, sign = words[words.index("bend") + 1], 1 if "positive" in words else -1
    step = 0.1 * sign * np.eye(6)[ARM.joint_names.index(name)]
    assert least(q + step) > 3.0 * least(q)


def test_every_status_that_ends_a_servo_or_holds_it_has_a_row():
    assert {status for _, statuses, _, _ in TABLE for status in statuses} == set(Status)
    assert all(told(status, "")[0] for status in Status if status not in (
        Status.SERVOING, Status.JOINT_LIMIT, Status.NEAR_SINGULARITY, Status.OUT_OF_REACH))
