"""What the controller node decides, with a servo and a sequence that only note what they are asked."""

from dataclasses import replace

import numpy as np
import pytest
from toy_plant import arm, GOAL

from aras_visual_servo import (
    ExperimentSequence, FEATURE_NAMES, Features, ParameterError, Reference, Servo, Session, Status)
from aras_visual_servo.runs.session import STANDSTILL_S

MS = 1_000_000
ASKED = []  # (stamp_ns, z_star_m) that the camera was asked to teach
SERVO = {"law": "decoupled", "mode": "continuous", "gains_per_s": dict.fromkeys(FEATURE_NAMES, 1.0),
         "thresholds": dict.fromkeys(FEATURE_NAMES, 1e-3), "time_limit_s": 20.0}
EXPERIMENT = {"goal": {"joints": GOAL}, "start": {"joints": GOAL}, "z_star_m": 0.5}
SEEN = Features(target_visible=True, valid=True, has_reference=True, area=0.01, xg=0.1, yg=0.0, alpha=0.1, xn=0.05,
                yn=0.0, an=0.5, z_star_m=0.5, area_star=0.01)


@pytest.fixture
def session():
    kinematics = arm()
    servo = Servo(kinematics, SERVO)
    servo.set_reference(Reference(np.array([0.0, 0.0, 0.5, 0.0])))
    sequence = ExperimentSequence(kinematics, servo, EXPERIMENT, lambda *asked: ASKED.append(asked))
    return Session(sequence, input_timeout_s=0.2, time_limit_s=20.0)


Q = arm().vector(GOAL)


def servoing(session):
    """Let it servo on two images, at 0 and 33 ms."""
    session.begin("taught", "", (), (), 0.0, 0, 0.0)
    for stamp_ns in (0, 33 * MS):
        command, record = session.answer(stamp_ns, SEEN, Q, stamp_ns, 0.0)
    assert record.status == Status.SERVOING and any(command.velocity.values())
    return session


def still(command):
    return not command.position and not any(command.velocity.values())


def test_answers_an_image_while_idle_with_an_empty_command(session):
    command, record = session.answer(0, SEEN, Q, 0, 0.0)
    assert (command.position, command.velocity, record.phase) == ({}, {}, "idle")


@pytest.mark.parametrize("stamp_ns", [33 * MS, 10 * MS])
def test_refuses_an_image_that_is_not_newer_than_the_last(session, stamp_ns):
    command, record = servoing(session).answer(stamp_ns, SEEN, Q, 40 * MS, 0.0)
    assert still(command) and command.stamp_ns == stamp_ns
    assert record.status == Status.STALE_INPUT and "came after" in record.status_text
    assert session.last_ns == 33 * MS


def test_refuses_an_image_without_a_joint_state_of_its_stamp(session):
    command, record = servoing(session).answer(66 * MS, SEEN, None, 66 * MS, 0.0)
    assert still(command) and record.status == Status.STALE_INPUT


def test_the_first_image_of_a_goal_may_have_the_stamp_of_one_answered_before_it(session):
    session.answer(0, SEEN, Q, 0, 0.0)  # then time is set back, where only this image has been seen
    session.begin("taught", "", (), (), 0.0, 0, 0.0)
    _, record = session.answer(0, SEEN, Q, 0, 0.0)
    assert record.status == Status.SERVOING and session.frame == 0


def test_refuses_an_image_older_than_the_input_timeout(session):
    command, record = servoing(session).answer(66 * MS, SEEN, Q, 267 * MS, 0.0)
    assert still(command) and record.status == Status.STALE_INPUT and "old" in record.status_text


def test_goes_on_with_the_next_good_image_after_a_refusal(session):
    servoing(session).answer(66 * MS, SEEN, None, 66 * MS, 0.0)
    command, record = session.answer(100 * MS, SEEN, Q, 100 * MS, 0.0)
    assert record.status == Status.SERVOING and not still(command)


def test_the_watchdog_is_silent_within_the_input_timeout(session):
    assert servoing(session).watch(233 * MS, 0.1) is None


def test_the_watchdog_stops_the_arm_after_the_input_timeout(session):
    command, record = servoing(session).watch(234 * MS, 0.1)
    assert still(command) and set(command.velocity) == set(arm().joint_names)
    assert record.status == Status.STALE_INPUT and session.stale and session.active


def test_the_watchdog_ends_a_goal_without_input_at_its_time_limit(session):
    _, record = servoing(session).watch(33 * MS + 20_001 * MS, 0.1)
    assert record.status == Status.TIMED_OUT and not session.active
    assert session.outcome(record)[:2] == (False, Status.TIMED_OUT)


def test_the_watchdog_commands_nothing_while_time_stands_still(session):
    command, record = servoing(session).watch(33 * MS, STANDSTILL_S + 0.1)
    assert command is None and record.status == Status.STALE_INPUT


def test_the_watchdog_is_silent_without_a_goal(session):
    assert session.watch(10**12, 1e6) is None


def test_a_stop_ends_the_goal_with_a_still_arm(session):
    command, record = servoing(session).end(50 * MS, "enough")
    assert still(command) and (record.status, record.status_text) == (Status.STOPPED, "enough")
    assert not session.active
    assert session.outcome(record)[:3] == (False, Status.STOPPED, "enough")


def test_a_stop_without_a_goal_is_a_standstill(session):
    command, record = session.end(50 * MS, "enough")
    assert still(command) and record is None


def test_a_bad_goal_lists_all_its_faults_and_starts_nothing(session):
    with pytest.raises(ParameterError) as error:
        session.begin("elsewhere", "no_such_law", (), (1.0,), 0.0, 0, 0.0)
    assert "elsewhere" in str(error.value) and "no_such_law" in str(error.value)
    assert not session.active


def test_teach_takes_the_image_answered_last_and_asks_the_camera_for_it_by_stamp(session):
    ASKED.clear()
    with pytest.raises(ParameterError, match="no image has come yet"):
        session.teach()
    session.answer(0, replace(SEEN, xg=0.3), Q, 0, 0.0)
    session.answer(33 * MS, SEEN, Q, 33 * MS, 0.0)
    assert session.teach(0.4) == 33 * MS and ASKED == [(33 * MS, 0.4)]
    np.testing.assert_array_equal(session._sequence.servo.reference.s_star, [0.4 * 0.1, 0.0, 0.4, 0.1])
    assert session.teach() == 33 * MS and ASKED[1:] == [(33 * MS, EXPERIMENT["z_star_m"])]


def test_teach_is_refused_while_a_goal_is_active(session):
    servoing(session)
    with pytest.raises(ParameterError, match="active"):
        session.teach()


def test_after_a_restart_of_time_stamps_start_anew(session):
    servoing(session).end(50 * MS, "time went back")
    session.restart_time()
    _, record = session.answer(0, SEEN, Q, 0, 0.0)
    assert "came after" not in record.status_text and session.frame == 0


def test_a_goal_is_unseen_until_its_first_image(session):
    assert not session.unseen
    session.begin("taught", "", (), (), 0.0, 0, 0.0)
    assert session.unseen
    session.answer(0, SEEN, None, 0, 0.0)  # refused: there is no joint state
    assert session.unseen
    session.answer(33 * MS, SEEN, Q, 33 * MS, 0.0)
    assert not session.unseen
    session.end(50 * MS, "enough")
    session.begin("taught", "", (), (), 0.0, 50 * MS, 0.0)
    assert session.unseen
    session.end(60 * MS, "enough")
    assert not session.unseen
