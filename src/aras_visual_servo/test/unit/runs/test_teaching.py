"""The taught view is the mean of as many images as their noise asks for."""

from dataclasses import replace

import numpy as np
import pytest
from bench import Bench

from aras_visual_servo.runs.teaching import FEW, Teaching

NOISE_SEED, STAMP_NS = 3, 7
STOP = {"position_m": 0.0001, "rotation_rad": 0.0005}


def taught(noise_m, most=300, **changes):
    """(bench, `Teaching` that is done, images that it took) of views whose xn has this noise."""
    bench = Bench(thresholds=dict.fromkeys(("xn", "yn", "an", "alpha"), 1e-4), stop=STOP, **changes)
    rng, exact = np.random.default_rng(NOISE_SEED), bench.camera.features(bench.X_WG)

    def image(**fields):
        return replace(exact, xn=exact.xn + noise_m * rng.normal(), reference_stamp_ns=STAMP_NS, **fields)

    teaching, images = Teaching(bench.servo, STAMP_NS, image(), bench.goal_q, bench.camera.star[0], most), 1
    while not teaching.done:
        teaching.add(image(), bench.goal_q)
        images += 1
    return bench, teaching, images


def test_images_without_noise_need_a_second_one_that_shows_it():
    bench, teaching, images = taught(0.0)
    assert images == teaching.reference.images == 2
    np.testing.assert_allclose(teaching.reference.s_star, bench.servo.reference.s_star, rtol=0.0, atol=1e-12)


def test_noise_is_averaged_out_to_a_part_of_the_thresholds():
    bench, teaching, images = taught(5e-5)
    assert FEW < images == teaching.reference.images < 60
    assert abs(teaching.reference.s_star[0] - bench.servo.reference.s_star[0]) < 3.0 * 1e-5


@pytest.mark.parametrize("most", [1, 20])
def test_there_are_at_most_as_many_images_as_allowed(most):
    assert taught(0.01, most=most)[2] == most


def test_a_goal_that_may_move_is_taught_from_one_image():
    assert taught(0.01, feed_forward={})[2] == 1


def test_images_relative_to_another_reference_do_not_count():
    bench = Bench()
    exact = bench.camera.features(bench.X_WG)
    teaching = Teaching(bench.servo, STAMP_NS, exact, bench.goal_q, bench.camera.star[0], 5)
    for _ in range(4):
        teaching.add(replace(exact, xn=1.0, reference_stamp_ns=STAMP_NS - 1), bench.goal_q)
    assert teaching.done and teaching.reference.images == 1
    np.testing.assert_allclose(teaching.reference.s_star, bench.servo.reference.s_star)
