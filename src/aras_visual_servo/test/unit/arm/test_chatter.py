"""A joint that reverses at full speed from image to image chatters; one that turns round now and then does not."""

import numpy as np
import pytest

from aras_visual_servo.arm.motion import Chatter

LIMIT = np.array([5.0, 5.0, np.inf])


def told(velocities):
    """Names found, image by image, of an arm whose second joint is told these velocities."""
    chatter = Chatter(("J1", "J2", "J3"), LIMIT)
    return [chatter.joint(np.array([0.1, velocity, 0.0])) for velocity in velocities]


def test_full_speed_both_ways_is_told_after_a_few_images_and_forgotten_after_a_few_more():
    found = told([4.8, -4.8] * 5 + [1.0] * 10)
    assert found[2] is None and found[3] == "J2" and found[9] == "J2" and found[-1] is None


@pytest.mark.parametrize("velocities", [[0.3, -0.3] * 20, [4.0] * 10 + [-4.0] * 10, ([4.0] * 6 + [-4.0] * 6) * 4])
def test_slow_trembling_and_turning_round_are_none(velocities):
    assert set(told(velocities)) == {None}


def test_a_joint_that_stood_still_begins_anew():
    chatter = Chatter(("J2",), LIMIT[:1])
    for velocity in (4.0, -4.0, 4.0):
        chatter.joint(np.array([velocity]))
    chatter.clear()
    assert chatter.joint(np.array([-4.0])) is None
