"""Whether the servo begins again for a target that has moved, image by image."""

import numpy as np
import pytest

from aras_visual_servo.spatial import rotation_rpy
from aras_visual_servo.ground.types import Status
from aras_visual_servo_study.live.following import FOLLOWED, Following

REST = np.eye(4)


def moved(way_m=0.01, turn=0.0):
    X_WT = np.eye(4)
    X_WT[:3, :3], X_WT[1, 3] = rotation_rpy((0.0, 0.0, turn)), way_m
    return X_WT


def ended(status, before=REST, last=REST):
    """One that has seen a servo begin at a place of the target and end at another."""
    following = Following()
    assert not following.answered("settle_start", Status.IDLE, moved(0.5), True)
    for X_WT in (before, last):
        assert not following.answered("servo", Status.SERVOING, X_WT, True)
    again = following.answered("done", status, last, True)
    return again, following


@pytest.mark.parametrize("status", [status for status in Status if status != Status.SERVOING])
def test_a_target_that_moves_afterwards_is_followed_where_the_servo_had_found_it(status):
    again, following = ended(status)
    assert not again and not following.answered("done", status, REST, True)
    assert following.answered("done", status, moved(), True) == (status in FOLLOWED)


@pytest.mark.parametrize("X_WT, again", [(moved(1.9e-4), False), (moved(2.1e-4), True), (moved(-2.1e-4), True),
                                         (moved(0.0, 0.9e-3), False), (moved(0.0, 1.1e-3), True),
                                         (moved(0.0, -1.1e-3), True)])
def test_how_far_it_has_to_move_or_turn(X_WT, again):
    _, following = ended(Status.CONVERGED)
    assert following.answered("done", Status.CONVERGED, X_WT, True) == again


def test_it_is_said_once_for_each_place():
    _, following = ended(Status.CONVERGED)
    assert following.answered("done", Status.CONVERGED, moved(0.01), True)
    assert not following.answered("done", Status.CONVERGED, moved(0.01), True)
    assert following.answered("done", Status.CONVERGED, moved(0.02), True)


def test_one_that_moved_while_it_was_not_followed_is_followed_from_then_on():
    _, following = ended(Status.CONVERGED)
    assert not following.answered("done", Status.CONVERGED, moved(), False)
    assert following.answered("done", Status.CONVERGED, moved(), True)


def test_after_a_servo_whose_time_was_up_it_counts_where_the_target_was_when_the_servo_began():
    assert ended(Status.TIMED_OUT, last=moved())[0] and not ended(Status.CONVERGED, last=moved())[0]
    assert not ended(Status.TIMED_OUT, before=moved(), last=moved())[0]
    _, following = ended(Status.TIMED_OUT, last=moved())
    # The next servo begins where the target rests by now: its end is the end.
    assert not following.answered("servo", Status.SERVOING, moved(), True)
    assert not following.answered("done", Status.TIMED_OUT, moved(), True)


def test_a_view_that_is_taught_is_one_that_need_not_be_followed():
    _, following = ended(Status.CONVERGED)
    assert not following.answered("done", Status.CONVERGED, moved(), False)
    following.taught()
    assert not following.answered("done", Status.CONVERGED, moved(), True)
    assert following.answered("done", Status.CONVERGED, moved(0.02), True)
