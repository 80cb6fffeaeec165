"""A goal is sent until it is taken."""
from types import SimpleNamespace

import pytest

from aras_visual_servo_controller.nodes.calls import AGAIN_S, GoalSender


def goal(name):
    return SimpleNamespace(goal_id=SimpleNamespace(id=name))


@pytest.fixture
def sent():
    return []


@pytest.fixture
def sender(sent):
    return GoalSender(sent.append)


def test_a_goal_that_is_not_taken_is_sent_again_as_the_same_goal(sender, sent):
    first = goal("first")
    sender.send(first, 10.0)
    sender.look(10.0 + 0.9 * AGAIN_S)
    assert sent == [first]
    sender.heard({"first": True, "other": False})  # seen, but pending
    sender.look(10.0 + AGAIN_S)
    assert sent == [first, first] and not sender.taken
    sender.look(10.0 + 1.5 * AGAIN_S)
    assert len(sent) == 2


def test_a_goal_that_was_taken_is_not_sent_again(sender, sent):
    sender.send(goal("first"), 10.0)
    sender.heard({"first": False})
    sender.heard({})  # forgotten by the server, long after its end
    sender.look(100.0)
    assert len(sent) == 1 and sender.taken


def test_the_next_goal_is_one_that_must_be_taken_anew(sender, sent):
    sender.look(5.0)
    assert sent == []
    sender.send(goal("first"), 10.0)
    sender.heard({"first": False})
    sender.send(goal("second"), 20.0)
    assert not sender.taken and sender.goal_id == "second"
    sender.heard({"first": False})
    sender.look(20.0 + AGAIN_S)
    assert [one.goal_id.id for one in sent] == ["first", "second", "second"]
