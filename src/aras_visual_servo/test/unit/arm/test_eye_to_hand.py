"""Eye-to-hand: the arm carries the target before a camera that stands still. The chain against differences and against
the chains that it is made of, for both arms."""

import numpy as np
import pytest

from aras_visual_servo import kinematics_of, load_scenario, ModelError, plane_from_pose, View
from aras_visual_servo.features.points import point_rows
from aras_visual_servo.spatial import adjoint, inverse, pose_from_rpy

STEP = 1e-6  # of central differences [m, rad]
#: Truncation STEP^2 / 6 = 2e-13, rounding eps / STEP = 2e-10 on lengths near 1.6 m, times ten.
DIFFERENCE = 4e-9
#: Of ln w and of image points: the same, with inverse depths and inverse singular values up to about 20.
SMALLER_DIFFERENCE = 1e-7
ROUNDING = 1e-12  # of a product of nine transforms with entries near 1
ARMS, SEEDS = ("experiment_1", "six_dof_rectangle"), range(4)
SIX_ROWS = list(range(6))


def urdf_and_robot(arm, **more):
    scenario = load_scenario(arm)
    return scenario.urdf_xml(), {**scenario.robot, "tip_link": "stand_optical_frame", "target_link": "link6", **more}


def chain(arm, **more):
    return kinematics_of(*urdf_and_robot(arm, **more))


def posture(kinematics, seed):
    return np.random.default_rng(seed).uniform(-1.2, 1.2, len(kinematics.joint_names))


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", SEEDS)
def test_jacobian_is_the_derivative_of_the_camera_s_pose_in_the_hand(arm, seed):
    kinematics = chain(arm)
    q = posture(kinematics, seed)
    R, J = kinematics.pose(q)[:3, :3], kinematics.jacobian(q)
    for i, step in enumerate(np.eye(len(q)) * STEP):
        dX = (kinematics.pose(q + step) - kinematics.pose(q - step)) / (2.0 * STEP)
        spin = R.T @ dX[:3, :3]
        twist = np.r_[R.T @ dX[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
        np.testing.assert_allclose(J[:, i], twist, atol=DIFFERENCE)


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", SEEDS)
def test_jacobian_is_that_of_the_hand_seen_from_the_camera_with_a_minus(arm, seed):
    kinematics, (urdf, robot) = chain(arm), urdf_and_robot(arm)
    hand = kinematics_of(urdf, {**robot, "tip_link": "link6", "target_link": None})
    q = posture(kinematics, seed)
    X_CE = inverse(kinematics.pose(q))
    np.testing.assert_allclose(kinematics.jacobian(q), -adjoint(X_CE) @ hand.jacobian(q), atol=10.0 * ROUNDING)
    np.testing.assert_allclose(hand.pose(q) @ kinematics.pose(q), kinematics.camera(q), atol=ROUNDING)


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", SEEDS)
def test_points_of_a_target_in_the_hand_move_as_the_interaction_matrix_says(arm, seed):
    kinematics, rng = chain(arm), np.random.default_rng(100 + seed)
    q = posture(kinematics, seed)
    X_CT = pose_from_rpy([0.05, -0.04, 0.6], [np.pi + 0.3, 0.2, 0.4])  # its face to the camera, tilted
    X_ET = kinematics.pose(q) @ X_CT
    corners = np.c_[rng.uniform(-0.1, 0.1, (4, 2)), np.zeros(4), np.ones(4)]

    def seen(joints):
        p = (inverse(kinematics.pose(joints)) @ X_ET @ corners.T)[:3]
        return (p[:2] / p[2]).T

    class Features:
        point_x, point_y = seen(q).T

    plane = plane_from_pose(X_CT[:3, 2], X_CT[:3, 3])
    found = point_rows(View(Features, plane)) @ kinematics.jacobian(q)
    for i, step in enumerate(np.eye(len(q)) * STEP):
        change = (seen(q + step) - seen(q - step)).ravel() / (2.0 * STEP)
        np.testing.assert_allclose(found[:, i], change, atol=SMALLER_DIFFERENCE)
        if np.abs(change).max() > 0.1:  # the other sign would be seen
            assert np.abs(found[:, i] + change).max() > 0.1


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", SEEDS)
def test_gradient_of_the_manipulability_is_its_derivative(arm, seed):
    kinematics = chain(arm)
    q = posture(kinematics, seed)
    w, gradient = kinematics.manipulability(q, 0.05, SIX_ROWS)
    assert w > 0.0
    for i, step in enumerate(np.eye(len(q)) * STEP):
        after, before = (kinematics.manipulability(at, 0.05, SIX_ROWS)[0] for at in (q + step, q - step))
        assert gradient[i] == pytest.approx((np.log(after) - np.log(before)) / (2.0 * STEP), abs=SMALLER_DIFFERENCE,
                                            rel=1e-6)


@pytest.mark.parametrize("arm", ARMS)
def test_joints_limits_and_their_order_are_those_of_the_arm(arm):
    scenario, kinematics = load_scenario(arm), chain(arm)
    plain = kinematics_of(scenario.urdf_xml(), scenario.robot)
    assert kinematics.joint_names == plain.joint_names
    for name in ("lower", "upper", "velocity"):
        np.testing.assert_array_equal(getattr(kinematics, name), getattr(plain, name))


def test_the_camera_stands_where_the_urdf_has_it_at_every_posture():
    kinematics = chain("experiment_1")
    for seed in SEEDS:
        camera = kinematics.camera(posture(kinematics, seed))
        np.testing.assert_allclose(camera, pose_from_rpy([0.03, 0.05, 0.17], [0.0, 0.0, 0.0]), atol=ROUNDING)


def test_a_calibrated_camera_stands_where_the_calibration_has_it():
    place = {"link": "world", "position_m": [0.3, 0.2, 0.1], "rpy_rad": [0.1, -0.2, 0.3]}
    kinematics = chain("experiment_1", hand_eye=place)
    expected = pose_from_rpy(place["position_m"], place["rpy_rad"])
    np.testing.assert_allclose(kinematics.camera(posture(kinematics, 1)), expected, atol=ROUNDING)


@pytest.mark.parametrize("changes, cause", [
    ({"tip_link": "link1"}, "camera 'link1': .*J1, gantry"),
    ({"tip_link": "camera_optical_frame"}, "'link6' and 'camera_optical_frame'"),
    ({"target_link": "tool"}, "no link 'tool'"),
    ({"target_link": "rail"}, "no moving joint between 'world' and 'rail'"),
    ({"base_link": "link6", "target_link": "slider"}, "'slider' is not below link 'link6'")])
def test_a_camera_or_a_target_that_cannot_be_is_refused_by_name(changes, cause):
    with pytest.raises(ModelError, match=cause):
        chain("experiment_1", **changes)
