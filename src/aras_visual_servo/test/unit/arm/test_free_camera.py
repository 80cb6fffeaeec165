"""A camera that flies freely: its pose, its Jacobian, and its coordinates at half a turn and beyond."""

import numpy as np
import pytest
from scipy.linalg import expm

from aras_visual_servo import (
    ExperimentSettings, Kinematics, load_scenario, ModelError, NotFiniteError, ParameterError, reach, resolve_uri,
    robot_kinematics, ServoSettings, ShapeError, TwistInverse)
from aras_visual_servo.arm.free_camera import FreeCamera, NAMES
from aras_visual_servo.arm.motion import ArmMotion
from aras_visual_servo.arm.trajectory import JointTrajectory
from aras_visual_servo.spatial import exponential, inverse, pose_from_rpy, rotation, rotation_vector

URDF = resolve_uri("package://aras_description/urdf/free_camera.urdf").read_text()
ASKEW = """<robot name="askew"><link name="world"/><link name="body"/><link name="eye"/>
<joint name="free" type="floating"><parent link="world"/><child link="body"/></joint>
<joint name="mount" type="fixed"><parent link="body"/><child link="eye"/>
<origin xyz="0.05 -0.02 0.1" rpy="0.3 -0.4 1.1"/></joint></robot>"""
ROUNDING = 1e-14  # some ten operations on numbers near one
#: Near half a turn the axis is as exact as the entries of the matrix, times a few operations.
AXIS_ROUNDING = 1e-13
STEP = 1e-6  # of central differences; their truncation is STEP^2, their rounding eps / STEP
DIFFERENCE = 1e-9
SEEDS = range(6)


def free():
    return robot_kinematics(URDF, "world", "camera_optical_frame")


def place(seed, angle=None):
    """Coordinates: somewhere, turned by this angle about some axis."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    angle = rng.uniform(0.0, 3.0) if angle is None else angle
    return np.r_[rng.uniform(-1.0, 1.0, 3), angle * axis / np.linalg.norm(axis)]


def test_the_camera_is_where_the_body_carries_it():
    bare = ASKEW.replace('<origin xyz="0.05 -0.02 0.1" rpy="0.3 -0.4 1.1"/>', "")
    for urdf, X_BE in ((ASKEW, pose_from_rpy([0.05, -0.02, 0.1], [0.3, -0.4, 1.1])), (bare, np.eye(4))):
        np.testing.assert_allclose(robot_kinematics(urdf, "world", "eye").pose(np.zeros(6)), X_BE, atol=ROUNDING)


def test_the_floating_joint_decides_what_a_robot_is():
    assert isinstance(free(), FreeCamera) and free().joint_names == NAMES == tuple(sorted(NAMES))
    arm = load_scenario("experiment_1")
    assert isinstance(robot_kinematics(arm.urdf_xml(), "world", "camera_optical_frame"), Kinematics)


@pytest.mark.parametrize("seed", SEEDS)
def test_pose_is_place_and_rotation_vector(seed):
    q = place(seed)
    X = free().pose(q)
    np.testing.assert_array_equal(X[:3, 3], q[:3])
    np.testing.assert_allclose(X[:3, :3], rotation(q[3:]), atol=ROUNDING)
    np.testing.assert_allclose(free().coordinates(X), q, atol=ROUNDING)


def test_jacobian_of_the_optical_frame_is_the_identity_everywhere():
    for angle in (0.0, 1.0, np.pi, -np.pi):
        np.testing.assert_array_equal(free().jacobian(place(1, angle)), np.eye(6))
        exact = TwistInverse((1.0,) * 6, 0.05, 0.02, 0.02)(np.eye(6))
        held, factor = free().held(exact, np.eye(6), place(1, angle), 100.0 * place(2), 0.1, 0.25)
        assert factor == 1.0 and np.array_equal(held, 100.0 * place(2))
    w, slope = free().manipulability(place(1, np.pi), 0.05, range(6))
    assert w == pytest.approx(20.0**3) and not slope.any()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("angle", [0.4, np.pi])
def test_jacobian_of_a_camera_that_sits_askew_is_the_derivative_of_its_pose(seed, angle):
    kinematics, q = robot_kinematics(ASKEW, "world", "eye"), place(seed, angle)
    X, J = kinematics.pose(q), kinematics.jacobian(q)
    for i, axis in enumerate(np.eye(6)):
        ahead, behind = (kinematics.pose(kinematics.moved(q, axis, step)) for step in (STEP, -STEP))
        slope = inverse(X) @ (ahead - behind) / (2.0 * STEP)
        np.testing.assert_allclose(J[:, i], [*slope[:3, 3], slope[2, 1], slope[0, 2], slope[1, 0]], atol=DIFFERENCE)
    np.testing.assert_allclose(kinematics.pose(kinematics.coordinates(X)), X, atol=AXIS_ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_moved_is_the_exponential_also_through_half_a_turn(seed):
    kinematics, q = free(), place(seed, 3.0)
    V = np.r_[0.3, -0.2, 0.1, 2.0 * q[3:]]  # six radians further: through pi, and beyond a whole turn
    hat = np.zeros((4, 4))
    hat[:3, :3], hat[:3, 3] = [[0, -V[5], V[4]], [V[5], 0, -V[3]], [-V[4], V[3], 0]], V[:3]
    np.testing.assert_allclose(kinematics.pose(kinematics.moved(q, V, 1.0)), kinematics.pose(q) @ expm(hat),
                               atol=AXIS_ROUNDING)
    there = q
    for _ in range(100):
        there = kinematics.moved(there, V, 0.01)
        assert np.linalg.norm(there[3:]) <= np.pi + ROUNDING
    np.testing.assert_allclose(kinematics.pose(there), kinematics.pose(q) @ expm(hat), atol=100 * AXIS_ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, 3.0, np.pi])
def test_way_leads_there(seed, angle):
    kinematics, q = free(), place(seed)
    end = kinematics.coordinates(kinematics.pose(q) @ exponential(place(seed + 10, angle)))
    np.testing.assert_allclose(kinematics.pose(kinematics.moved(q, kinematics.way(q, end), 1.0)), kinematics.pose(end),
                               atol=AXIS_ROUNDING)


def test_two_writings_of_half_a_turn_are_the_same_place():
    one, other = place(3, np.pi), place(3, -np.pi)
    assert np.abs(one - other).max() > 1.0
    np.testing.assert_allclose(free().way(one, other), 0.0, atol=AXIS_ROUNDING)


def test_reach_needs_no_search():
    kinematics, q = free(), place(2, np.pi)
    joints, refusal = reach(kinematics, place(5), kinematics.pose(q))
    assert refusal == ""
    np.testing.assert_allclose(kinematics.pose(kinematics.vector(joints)), kinematics.pose(q), atol=AXIS_ROUNDING)


def test_trajectory_is_a_screw_at_rest_at_both_ends():
    kinematics = free()
    begin, end = kinematics.coordinates(np.eye(4)), place(4, np.pi)
    trajectory = JointTrajectory(kinematics, begin, end, kinematics.velocity, 2.0)
    assert trajectory.duration_s > 1.0
    np.testing.assert_array_equal(trajectory.position(trajectory.duration_s), end)
    half = kinematics.moved(begin, kinematics.way(begin, end), 0.5)
    np.testing.assert_allclose(trajectory.position(0.5 * trajectory.duration_s), half, atol=AXIS_ROUNDING)
    V = trajectory.velocity(0.3, 0.1)
    np.testing.assert_allclose(kinematics.moved(trajectory.position(0.3), V, 0.1), trajectory.position(0.4),
                               atol=AXIS_ROUNDING)


def test_motion_does_the_twist_itself_and_nothing_beside():
    scenario = load_scenario("free_camera")
    kinematics = free()
    arm = ArmMotion(kinematics, ServoSettings.from_dict(scenario.servo, NAMES), True)
    twist, q = np.array([0.3, -2.0, 1.0, 4.0, -3.0, 2.0]), place(1, np.pi)
    motion = arm.joint_velocity(q, twist, *arm.at(q), 1.0 / 30.0)
    np.testing.assert_allclose(motion.q_dot, twist, atol=ROUNDING)
    assert motion.status is None


@pytest.mark.parametrize("text, words", [
    (ASKEW.replace('<joint name="mount" type="fixed">', '<joint name="mount" type="floating">'), "floating, floating"),
    (ASKEW.replace('<joint name="mount" type="fixed">', '<joint name="mount" type="revolute">'), "floating, revolute"),
])
def test_other_chains_are_refused(text, words):
    with pytest.raises(ModelError, match=words):
        robot_kinematics(text, "world", "eye")


def test_bad_coordinates_are_refused():
    with pytest.raises(ShapeError, match="5 values, expected 6"):
        free().pose(np.zeros(5))
    with pytest.raises(NotFiniteError):
        free().jacobian(np.full(6, np.nan))


# --- goal and start as camera poses ---------------------------------------------------------------------------------


def test_goal_and_start_are_camera_poses():
    scenario, kinematics = load_scenario("free_camera"), free()
    X = kinematics.pose(scenario.goal_posture(kinematics))
    np.testing.assert_allclose(X, [[0, 1, 0, -0.050017], [1, 0, 0, 0], [0, 0, -1, 0.862227], [0, 0, 0, 1]], atol=1e-13)
    config = ExperimentSettings.from_dict(scenario.experiment, kinematics)
    np.testing.assert_array_equal(kinematics.vector(config.start.joints), scenario.start_posture(kinematics))


def test_an_arm_takes_a_camera_pose_too():
    scenario = load_scenario("six_dof_canonical")
    kinematics = robot_kinematics(scenario.urdf_xml(), "world", "camera_optical_frame")
    pose = load_scenario("free_camera").experiment["start"]["camera"]
    moved = scenario.with_overrides({"experiment.start": {"camera": pose}})
    X = kinematics.pose(moved.start_posture(kinematics))
    np.testing.assert_allclose(X[:3, 3], pose["position_m"], atol=1e-4)  # arm.reach.REACHED_M
    assert np.linalg.norm(rotation_vector(X[:3, :3].T @ free().pose(
        load_scenario("free_camera").start_posture(free()))[:3, :3])) < 5e-4
    far = scenario.with_overrides({"experiment.start": {"camera": {**pose, "position_m": [9.0, 0.0, 0.5]}}})
    with pytest.raises(ParameterError, match="camera: camera pose out of reach"):
        far.start_posture(kinematics)


@pytest.mark.parametrize("place_text, found", [({}, "neither"), ({"joints": {"px": 0.0}, "camera": {
    "position_m": [0.0, 0.0, 0.0], "rpy_rad": [0.0, 0.0, 0.0]}}, "both")])
def test_a_place_is_joints_or_camera(place_text, found):
    with pytest.raises(ParameterError, match=f"experiment.goal: found {found} "):
        load_scenario("free_camera").with_overrides({"experiment.goal": place_text})


def test_a_twist_that_goes_to_and_fro_is_no_singularity_of_a_free_camera():
    camera = free()
    config = ServoSettings.from_dict(load_scenario("free_camera").servo, camera.joint_names)
    arm, q = ArmMotion(camera, config, sees_tilt=True), np.zeros(6)
    for number in range(20):
        jacobian, turned = arm.at(q)
        twist = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 2.0]) * (-1) ** number
        assert arm.joint_velocity(q, twist, jacobian, turned, 1.0 / 30.0).status is None
