"""Poses and rotations, and the types that everything exchanges."""

import math
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from aras_visual_servo import Features, ParameterError, Reference, ServoRecord, Status
from aras_visual_servo.spatial import (
    adjoint, adjoints, exponential, exponentials, inverse, logarithm, pose_from_quaternion, quaternion_xyzw, rotation,
    rotation_angle, rotation_rpy, rotation_vector, skew)

#: Of the axes of rotation that a test tries in turn. As tests of their own they would be fifteen hundred.
SEEDS = range(40)
#: Some tens of operations on numbers near one.
ROUNDING = 2e-15
#: Near half a turn the axis is as exact as the entries of the matrix, times a few operations.
AXIS_ROUNDING = 2e-14


def axis_of(seed):
    axis = np.random.default_rng(seed).normal(size=3)
    return axis / np.linalg.norm(axis)


def matrix_of(twist):
    (vx, vy, vz), (wx, wy, wz) = twist[:3], twist[3:]
    return np.array([[0, -wz, wy, vx], [wz, 0, -wx, vy], [-wy, wx, 0, vz], [0, 0, 0, 0]])


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-12, 1e-9, 1e-7, 2e-5, 1e-3, 0.5, 1.5, 2.6, 2.7, 3.0])
def test_a_rotation_vector_comes_back_from_its_matrix(angle):
    for seed in SEEDS:
        vector = angle * axis_of(seed)
        R = Rotation.from_rotvec(vector).as_matrix()
        np.testing.assert_allclose(rotation_vector(R), vector, rtol=0.0, atol=ROUNDING)
        assert rotation_angle(R) == pytest.approx(angle, abs=ROUNDING)


@pytest.mark.parametrize("missing", [0.4, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_near_half_a_turn_the_vector_is_as_exact_as_anywhere(missing):
    for seed in SEEDS:
        vector = (math.pi - missing) * axis_of(seed)
        R = Rotation.from_rotvec(vector).as_matrix()
        np.testing.assert_allclose(rotation_vector(R), vector, rtol=0.0, atol=AXIS_ROUNDING)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), *(axis_of(seed) for seed in range(10))])
def test_half_a_turn_has_the_angle_pi_about_its_axis_or_the_opposite_one(axis):
    R = 2.0 * np.outer(axis, axis) - np.eye(3)
    vector = rotation_vector(R)
    assert np.linalg.norm(vector) == pytest.approx(math.pi, abs=AXIS_ROUNDING)
    np.testing.assert_allclose(np.cross(vector, axis), 0.0, atol=AXIS_ROUNDING)
    assert rotation_angle(R) == pytest.approx(math.pi, abs=ROUNDING)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.9e-5, 1.1e-5, 0.3, 2.0, math.pi, 5.0])
def test_rotation_and_exponential_are_those_of_the_matrix_exponential(angle):
    for seed in SEEDS:
        vector = angle * axis_of(seed)
        twist = np.concatenate([np.random.default_rng(seed + 100).normal(size=3), vector])
        expected = expm(matrix_of(twist))
        # scipy's own expm is good to some eps of the norm, here up to 6.
        np.testing.assert_allclose(exponential(twist)[:3, :3], expected[:3, :3], rtol=0.0, atol=1e-14)
        # Just above 1e-5 rad, 1 - cos has six digits left; they are multiplied by 1e-5 rad and some metres.
        np.testing.assert_allclose(exponential(twist)[:3, 3], expected[:3, 3], rtol=0.0, atol=5e-11)
        np.testing.assert_allclose(rotation(vector), expected[:3, :3], rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_inverse_undoes_a_pose(seed):
    X = exponential(np.random.default_rng(seed).normal(size=6))
    np.testing.assert_allclose(inverse(X) @ X, np.eye(4), atol=ROUNDING)
    np.testing.assert_allclose(X @ inverse(X), np.eye(4), atol=ROUNDING)


def test_roll_pitch_yaw_turn_about_fixed_axes_in_this_order():
    roll, pitch, yaw = 0.3, -0.5, 1.1
    by_axis = rotation([0, 0, yaw]) @ rotation([0, pitch, 0]) @ rotation([roll, 0, 0])
    np.testing.assert_allclose(rotation_rpy((roll, pitch, yaw)), by_axis, atol=ROUNDING)


@pytest.mark.parametrize("seed", range(5))
def test_a_pose_comes_back_from_position_and_quaternion_of_any_length(seed):
    X = exponential(np.random.default_rng(seed).normal(size=6))
    q = quaternion_xyzw(X[:3, :3])
    assert q[3] >= 0.0 and np.linalg.norm(q) == pytest.approx(1.0, abs=ROUNDING)
    np.testing.assert_allclose(pose_from_quaternion(X[:3, 3], 3.0 * q), X, atol=ROUNDING)


@pytest.mark.parametrize("angle", [0.0, 0.4, math.pi / 2, 3.0, -3.0, math.pi])
@pytest.mark.parametrize("R_0", [np.eye(3), np.diag([1.0, -1.0, -1.0]), rotation([0.0, 0.0, 0.7])[:, [1, 2, 0]]])
def test_the_quaternion_turns_as_the_matrix_does(angle, R_0):
    R = R_0 @ rotation([0.0, 0.0, angle])
    x, y, z, w = quaternion_xyzw(R)
    turned = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                       [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                       [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    assert w >= 0.0 and np.allclose(turned, R, atol=1e-14)  # eigenvectors of a 4 x 4: a few eps


def test_what_is_not_known_stays_unknown():
    assert np.isnan(quaternion_xyzw(np.full((3, 3), np.nan))).all()
    X = pose_from_quaternion((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 0.0))
    assert np.isnan(X[:3, :3]).all() and X[:3, 3].tolist() == [1.0, 2.0, 3.0]
    assert math.isnan(rotation_angle(np.full((3, 3), np.nan)))


@pytest.mark.parametrize("angle", [0.0, 1e-9, 9e-6, 1.1e-5, 1e-3, 0.5, 2.6, 3.0, math.pi - 1e-6])
def test_a_pose_comes_back_from_its_logarithm_and_a_twist_from_its_exponential(angle):
    for seed in SEEDS:
        twist = np.r_[np.random.default_rng(seed).normal(size=3), angle * axis_of(seed)]
        X = exponential(twist)
        # The coefficients of the series are differences of numbers near one over the angle squared: eps / 1e-10.
        np.testing.assert_allclose(exponential(logarithm(X)), X, rtol=0.0, atol=1e-6 * angle + AXIS_ROUNDING)
        np.testing.assert_allclose(logarithm(X), twist, rtol=0.0, atol=1e-5 * min(angle, 1e-3) + 10.0 * AXIS_ROUNDING)


def test_of_exactly_half_a_turn_the_logarithm_is_one_of_two_screws():
    for seed in SEEDS:
        X = exponential(np.r_[0.3, -0.2, 0.1, math.pi * axis_of(seed)])
        np.testing.assert_allclose(exponential(logarithm(X)), X, rtol=0.0, atol=10.0 * AXIS_ROUNDING)


def test_angles_and_quaternions_are_those_of_scipy_to_the_last_bit():
    # Poses of results were made by scipy's functions, which take a tenth of a second to import.
    random = np.random.default_rng(7)
    for _ in range(400):
        rpy = random.uniform(-4.0, 4.0, 3) * (random.random(3) > 0.3)
        R = Rotation.from_euler("xyz", rpy).as_matrix()
        np.testing.assert_array_equal(rotation_rpy(rpy), R)
        q = Rotation.from_matrix(R).as_quat()
        np.testing.assert_array_equal(quaternion_xyzw(R), q if q[3] >= 0.0 else -q)


def test_a_run_in_process_needs_no_scipy():
    code = ("import sys; import aras_visual_servo as avs; from aras_visual_servo_study.report.report import summarise; "
            "from aras_visual_servo.scenario.feasibility import check_feasible; "
            "scenario = avs.load_scenario('experiment_1'); check_feasible(scenario); "
            "summarise(avs.run(scenario)); sys.exit('scipy' in sys.modules)")
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize("seed", range(5))
def test_skew_is_the_cross_product_and_adjoint_moves_a_twist_to_the_other_frame(seed):
    rng = np.random.default_rng(seed)
    v, w, twist, X = rng.normal(size=3), rng.normal(size=3), rng.normal(size=6), exponential(rng.normal(size=6))
    np.testing.assert_allclose(skew(v) @ w, np.cross(v, w), rtol=0, atol=ROUNDING)
    moved = exponential(adjoint(X) @ twist)
    np.testing.assert_allclose(moved, X @ exponential(twist) @ inverse(X), rtol=0, atol=2e-13)


def test_of_many_twists_and_poses_come_the_same_values_as_of_each():
    twists = np.vstack([np.random.default_rng(0).normal(0.0, 2.0, (20, 6)), np.zeros(6), np.full(6, 1e-7),
                        [1.0, 2.0, 3.0, 0.0, 0.0, 1e-5]])
    poses = np.array([exponential(twist) for twist in twists])
    np.testing.assert_allclose(exponentials(twists), poses, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(adjoints(poses), [adjoint(X) for X in poses], rtol=0.0, atol=1e-14)


MESSAGES = Path(__file__).parents[4] / "aras_visual_servo_msgs" / "msg"


def message_lines(name):
    lines = [line.split("#")[0].split() for line in (MESSAGES / f"{name}.msg").read_text().splitlines()]
    return [line for line in lines if len(line) == 2]


def test_status_codes_are_those_of_the_message():
    constants = dict(line[1].split("=") for line in message_lines("ServoState") if "=" in line[1])
    assert {name: int(value) for name, value in constants.items()} == {status.name: status.value for status in Status}


@pytest.mark.parametrize("message, container, extra", [
    ("MomentFeatures", Features, set()),
    ("ServoState", ServoRecord, {"stamp_ns"}),
])  # fmt: skip
def test_container_has_the_fields_of_its_message(message, container, extra):
    names = {line[1] for line in message_lines(message) if "=" not in line[1]} - {"header"}
    assert {field.name for field in fields(container)} == names | extra


def test_features_copy_any_object_and_give_moments_by_name():
    source = SimpleNamespace(**{field.name: () if field.default == () else 0.0 for field in fields(Features)
                                if field.name != "age_s"})
    source.moment_names, source.m, source.mu = ["00", "10"], [2.0, 3.0], [2.0, 0.0]
    source.point_x, source.point_y = [0.1, 0.2], [0.3, 0.4]
    source.kernel_x, source.kernel_y = [1.0], [2.0]
    copy = Features.from_object(source)
    source.m[0] = source.point_x[0] = 9.0
    assert copy.raw_moments() == {"00": 2.0, "10": 3.0}
    assert copy.centred_moments() == {"00": 2.0, "10": 0.0}
    assert copy.point_x == (0.1, 0.2) and copy.point_y == (0.3, 0.4)


def test_reference_round_trip():
    reference = Reference(np.array([0.1, 0.2, 0.6, -1.0]), np.array([0.0, 0.0, -1.0]), {"J1": 0.5})
    back = Reference.from_dict(reference.to_dict())
    np.testing.assert_array_equal(back.s_star, reference.s_star)
    np.testing.assert_array_equal(back.optical_axis_B, reference.optical_axis_B)
    assert back.posture == reference.posture


def test_reference_without_attitude_round_trip():
    back = Reference.from_dict(Reference(np.zeros(4)).to_dict())
    assert back.optical_axis_B is None and back.posture is None


def test_reference_lists_every_fault():
    bad = {"s_star": [0.0, np.nan], "optical_axis_B": [0.0, np.nan, 1.0], "posture": 5, "more": 1}
    with pytest.raises(ParameterError) as caught:
        Reference.from_dict(bad)
    assert len(caught.value.faults) == 4
