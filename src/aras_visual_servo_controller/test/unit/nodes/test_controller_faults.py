"""What stops the arm when something raises while the controller node answers an image. No ROS master is needed."""

import numpy as np
import pytest
from toy_plant import arm, GOAL

from aras_visual_servo import Features, ServoRecord, Session, Status
from aras_visual_servo_controller.nodes import controller

STAMP_NS = 40_000_000


class Broken:
    """A sequence that raises at every image, and does not help to stop."""

    phase, done, teach_stamp_ns, result = "servo", False, None, None

    def step(self, observation):
        raise ZeroDivisionError("a law of somebody else")

    def start(self, servo_only):
        pass

    def stop(self, stamp_ns, reason):
        raise ZeroDivisionError("nor can it stop")


class Message:
    class header:
        frame_id = "camera_optical_frame"


class Joints:
    def unpack(self):
        return None

    def positions(self, _):
        return arm().vector(GOAL)


@pytest.fixture
def node(monkeypatch):
    """A node without ROS around it, which servos; what it sends, publishes and reports is in lists."""
    node = object.__new__(controller.ControllerNode)
    node._session = Session(arm(), None, Broken(), input_timeout_s=0.2, time_limit_s=20.0)
    node._session.active = True
    node._sequence, node._joints = Broken(), Joints()
    node.sent, node.records, node.finished = [], [], []
    node._send, node._publish_state, node._finish = node.sent.append, node.records.append, node.finished.append
    monkeypatch.setattr(controller.convert, "now_ns", lambda: STAMP_NS)
    monkeypatch.setattr(controller.rospy, "logerr", lambda *_: None)
    return node


def test_an_exception_sends_zero_velocity_to_every_joint_and_ends_the_goal(node):
    node._answer(STAMP_NS, Message, Joints())
    [command] = node.sent
    assert command.stamp_ns == STAMP_NS and not command.position
    assert command.velocity == dict.fromkeys(arm().joint_names, 0.0)
    [record] = node.records
    assert record.status == Status.FAULT and "ZeroDivisionError: a law of somebody else" in record.status_text
    assert node.finished == [record] and not node._session.active


def test_without_a_goal_an_exception_stops_the_arm_too_and_reports_nothing(node):
    node._session.active = False
    node._answer(STAMP_NS, Message, Joints())
    assert node.sent[0].velocity == dict.fromkeys(arm().joint_names, 0.0)
    assert node.records[0].status == Status.FAULT and node.finished == []


def test_an_exception_after_the_command_was_sent_is_followed_by_a_stop(node):
    """The record cannot be published: the arm must not go on with the velocity that it was given."""
    moving = node._session.standstill(STAMP_NS)
    moving.velocity = dict.fromkeys(arm().joint_names, 0.3)
    record = ServoRecord(STAMP_NS, Status.SERVOING)
    node._session.answer = lambda *_: (moving, record)

    def publish(found):
        if found is record:
            raise OSError("closed")
        node.records.append(found)

    node._publish_state = publish
    node._answer(STAMP_NS, Message, Joints())
    assert node.sent[0] is moving and node.sent[-1].velocity == dict.fromkeys(arm().joint_names, 0.0)
    assert node.records[-1].status == Status.FAULT


def test_features_that_are_fit_for_nothing_never_raise(node):
    class Headless(Message):
        pass

    node._seen = lambda *_: (Features(), np.full(6, np.nan), "")
    node._answer(STAMP_NS, Headless, Joints())
    assert node.sent[-1].velocity == dict.fromkeys(arm().joint_names, 0.0)
