"""RunRecord: rows, phases, images, missing values."""

import numpy as np
import pytest
from synthetic import blob, IMAGE_PERIOD_NS, make_record

from aras_visual_servo import Features, RecordBuilder, ServoRecord, ShapeError, Status


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
