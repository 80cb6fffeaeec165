"""Records of a run: built, stored, taught from, measured."""

from dataclasses import replace

import numpy as np
import pytest
from bench import Bench
from synthetic import blob, IMAGE_PERIOD_NS, make_record

from aras_visual_servo import (Features, measures, MEASURES, Outline, ParameterError, RecordBuilder, ServoRecord,
                               ShapeError, Status)
from aras_visual_servo.runs.measures import distance_from_segment
from aras_visual_servo.runs.settings import still
from aras_visual_servo.runs.teaching import FEW, Teaching
from aras_visual_servo.spatial import plane_depth, rotation


def builder():
    return RecordBuilder("test", ("J1", "J2"))


def test_what_was_not_given_is_nan_and_shapes_hold():
    b = builder()
    b.add_row(5, "servo")
    record = b.finish()
    assert record.e.shape == (1, 4) and record.q.shape == (1, 2) and record.X_WC.shape == (1, 4, 4)
    assert np.isnan(record.e).all() and np.isnan(record.X_WC).all() and record.desired_image is None


def test_an_empty_record_has_no_rows_and_keeps_its_shapes():
    record = builder().finish()
    assert len(record) == 0 and record.twist.shape == (0, 6) and record.servo_rows.size == 0


@pytest.mark.parametrize("name, value", [("s", [1.0]), ("twist", [0.0] * 5), ("q", [0.0] * 3), ("X_WC", np.eye(3))])
def test_a_wrong_length_is_refused_by_name(name, value):
    with pytest.raises(ShapeError, match=name):
        builder().add_row(0, "servo", **{name: value})


def test_joints_of_an_answer_are_matched_by_name():
    b = builder()
    b.add_answer(ServoRecord(1, Status.SERVOING, phase="servo", joint_names=("J2", "J1"), q=np.array([2.0, 1.0])),
                 features=Features(area=0.5, xg=0.1, yg=0.2, alpha=0.3))
    record = b.finish()
    assert record.q.tolist() == [[1.0, 2.0]] and np.isnan(record.set_point).all()
    assert record.raw.tolist() == [[0.5, 0.1, 0.2, 0.3]]


@pytest.mark.parametrize("z_star_m, moves, said", [
    (0.6, False, False), (0.65, False, False), (0.55, False, False), (0.67, False, True), (0.5, False, True),
    (0.6, True, True), (1.2, True, False)])
def test_a_depth_that_contradicts_the_true_one_is_noted(z_star_m, moves, said):
    """The camera looks down from 0.6 m; a target that moves was 0.6 m lower when it was taught."""
    X_WC, X_WT, lower = np.diag([1.0, -1.0, -1.0, 1.0]), np.eye(4), np.eye(4)
    X_WC[2, 3], lower[2, 3] = 0.6, -0.6
    b = RecordBuilder("test", ("J1", "J2"), settings={"experiment": {"z_star_m": z_star_m}})
    for phase, pose in (("to_goal", X_WT), ("teach", lower), ("servo", X_WT)):
        b.add_answer(ServoRecord(1, Status.SERVOING, phase=phase), X_WC=X_WC, X_WT=pose if moves else None)
    notes = b.finish(X_WT=X_WT).notes
    assert [note for note in notes if "z_star_m" in note and f"{z_star_m:g}" in note] == list(notes)
    assert len(notes) == said


def test_the_depth_is_that_of_the_plane_where_the_target_is_seen():
    """A plane tilted by 45 degrees, 1 m away on the axis, and a target to the side of it."""
    half = np.sqrt(0.5)
    X_CT = np.array([[half, 0.0, half, 0.0], [0.0, 1.0, 0.0, 0.0], [-half, 0.0, half, 1.0], [0.0, 0.0, 0.0, 1.0]])
    assert plane_depth(np.eye(4), X_CT) == pytest.approx(1.0)
    assert plane_depth(np.eye(4), X_CT, 0.25) == pytest.approx(0.8)
    assert np.isnan(plane_depth(np.eye(4), X_CT, -1.0))
    assert np.isnan(plane_depth(np.eye(4), X_CT, -2.0))


def test_images_kept_are_the_taught_the_first_and_the_last_of_the_servo_phase():
    record = make_record(servo_images=20)
    assert np.array_equal(record.desired_image, blob(0))
    assert np.array_equal(record.initial_image, blob(8))
    assert np.array_equal(record.final_image, blob(0))  # not the done row's, blob(15): the servo ended before it


def test_images_are_copied_because_the_renderer_reuses_its_buffer():
    b, image = builder(), blob(0)
    b.add_row(0, "teach", image=image)
    image[:] = 0
    assert np.array_equal(b.finish().desired_image, blob(0))


def test_servo_rows_end_at_the_row_that_reports_the_end():
    record = make_record(servo_images=20)
    assert record.phase[record.servo_rows].tolist() == ["servo"] * 20


def test_servo_rows_after_the_reported_end_do_not_count():
    b = builder()
    for status in (Status.SERVOING, Status.CONVERGED, Status.SERVOING):
        b.add_row(len(b), "servo", status)
    assert b.finish().servo_rows.tolist() == [0, 1]


def test_the_done_row_ends_the_servo_phase_when_no_servo_row_does():
    record = make_record(servo_images=20, status=Status.SERVOING)
    assert record.phase[record.servo_rows[-1]] == "done" and len(record.servo_rows) == 21


def test_real_time_factor_is_simulated_over_wall_time():
    record = make_record(servo_images=20)
    # 5 rows before, 20 of servo, 1 done: 25 periods in the 0.2 s make_record claims; rounding only.
    assert record.real_time_factor == pytest.approx(25 * IMAGE_PERIOD_NS * 1e-9 / 0.2, rel=1e-12)


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


def creeping(m_per_image, until=10**6):
    """`Teaching` of noisy views while the gantry creeps, and the bench's goal; stops creeping at an image."""
    bench = Bench(thresholds=dict.fromkeys(("xn", "yn", "an", "alpha"), 1e-4), stop=STOP)
    rng, exact = np.random.default_rng(NOISE_SEED), bench.camera.features(bench.X_WG)
    gantry, k = list(bench.arm.joint_names).index("gantry"), 0

    def image():
        q = np.array(bench.arm.vector(bench.goal_q))
        q[gantry] += m_per_image * min(k, until)
        return replace(exact, xn=exact.xn + 5e-5 * rng.normal(), reference_stamp_ns=STAMP_NS), q

    teaching = Teaching(bench.servo, STAMP_NS, *image(), bench.camera.star[0], 100, still(0.2, 0.3, 0.2, 0.1))
    while not teaching.done:
        k += 1
        teaching.add(*image())
    return bench, teaching, m_per_image * min(k, until)


def test_a_goal_is_refused_while_the_arm_moves_by_more_than_a_tenth_of_what_the_judge_allows():
    with pytest.raises(ParameterError, match="the camera moves, by 0.99 mm"):  # 99 times 10 um; allowed are 20 um
        creeping(1e-5)


def test_images_of_before_the_arm_rested_are_left_out_of_the_goal():
    bench, teaching, rest_m = creeping(1e-5, until=8)
    q = teaching.reference.posture["gantry"]
    assert FEW < teaching.reference.images < 60 and rest_m == pytest.approx(8e-5)
    assert abs(q - (dict(zip(bench.arm.joint_names, bench.arm.vector(bench.goal_q)))["gantry"] + rest_m)) < 2e-5


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


CAMERA = {"width": 320, "height": 240, "fx_px": 200.0}
DOWN = rotation(np.array([np.pi, 0.0, 0.0]))  # x stays, the camera looks along -z


def record_of(positions, q=((0.0, 0.5),)):
    builder = RecordBuilder("made_up", ("a", "b"))
    for i, p in enumerate([positions[-1], *positions]):
        X = np.eye(4)
        X[:3, :3], X[:3, 3] = DOWN, p
        phase, status = ("teach", Status.IDLE) if i == 0 else ("servo", Status.SERVOING)
        builder.add_row(i * 10**8, phase, status, q=q[min(i, len(q) - 1)], X_WC=X)
    return builder.finish()


def test_a_detour_is_longer_than_the_straight_line():
    path = [(0.0, 0.0, 0.5), (0.03, 0.04, 0.5), (0.1, 0.0, 0.5)]
    found = measures(record_of(path), [-1.0, -1.0], [1.0, 1.0])
    assert found["path_mm"] == pytest.approx(50.0 + np.hypot(70.0, 40.0))
    assert found["detour_mm"] == pytest.approx(40.0) and found["farthest_mm"] == pytest.approx(100.0)
    assert found["border_px"] is None and set(found) == set(MEASURES)


def test_beyond_the_ends_the_distance_is_from_the_end():
    points = np.array([[-3.0, 4.0, 0.0], [5.0, 2.0, 0.0], [12.0, 0.0, 0.0]])
    a, b = np.zeros(3), np.array([10.0, 0.0, 0.0])
    np.testing.assert_allclose(distance_from_segment(points, a, b), [5.0, 2.0, 2.0])
    np.testing.assert_allclose(distance_from_segment(points, a, a), [5.0, np.hypot(5.0, 2.0), 12.0])


def test_the_joint_nearest_to_a_limit_counts_free_ones_do_not():
    record = record_of([(0.0, 0.0, 0.5)] * 3, q=[(0.0, 0.0), (7.0, 0.5), (9.0, -1.7)])
    assert measures(record, [-np.inf, -2.0], [np.inf, 1.0])["joint_room"] == pytest.approx(0.3 / 1.5)
    assert measures(record, [-np.inf] * 2, [np.inf] * 2)["joint_room"] is None


def test_the_least_distance_of_the_target_from_the_border():
    square = [[[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]]
    outline = Outline(square, np.eye(4), CAMERA)
    found = measures(record_of([(0.0, 0.0, 0.5), (0.2, 0.0, 0.5), (0.1, 0.0, 0.5)]), [-1.0] * 2, [1.0] * 2, outline)
    # At x = 0.2 the left edge is 0.25 m aside at 0.5 m: 100 px left of the middle, 60 px from the border at -1/2.
    assert found["border_px"] == pytest.approx(60.0)
    cut = measures(record_of([(0.4, 0.0, 0.5)] * 2), [-1.0] * 2, [1.0] * 2, outline)
    assert cut["border_px"] == pytest.approx(160.0 - 0.45 / 0.5 * 200.0)
