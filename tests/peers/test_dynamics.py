"""Dynamics over random states and free swing, against Pinocchio and MuJoCo."""

import mujoco
import numpy as np
import ours
import pinocchio
import pytest
from robots import GRAVITY, robot

STATES = 100
#: Of the largest entry: some hundred roundings times the condition of what is solved.
SAME = 1e-10
#: Accelerations are our velocities' difference over one period without damping: the rounding of a velocity, 2e-16 of a
#: few rad/s, over the period, times the condition of the mass matrix, below 1e4.
PERIOD_S, DIFFERENCE = 1e-3, 1e-9

robots = pytest.mark.parametrize("name", sorted(ours.ROBOTS))


def off(found, expected):
    """Largest difference of two arrays, of the largest entry of the second."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    return np.abs(found - expected).max() / np.abs(expected).max()


def answers(one, states, **more):
    cases = [{"q": one.named(q), "v": one.named(v), "effort": one.named(effort), "steps": 1}
             for q, v, effort in states]
    return ours.world(one.urdf, cases, GRAVITY, PERIOD_S, actuated=True, **more)


@robots
def test_mass_matrix(name, compared):
    one, against_pin, against_mujoco = robot(name), [], []
    states = one.states(STATES, seed=1)
    for (q, v, _), found in zip(states, answers(one, states)):
        M = one.matrix_from_pin(pinocchio.crba(one.pin, one.data, one.to_pin(q)))
        against_pin.append(off(found["mass_matrix"], M))
        one.set_mujoco(q, v)
        against_mujoco.append(off(found["mass_matrix"], one.mass_matrix_of_mujoco()))
    compared(f"mass matrix, {name}", "Pinocchio", against_pin, SAME)
    compared(f"mass matrix, {name}", "MuJoCo", against_mujoco, SAME)


@robots
def test_acceleration_and_bias(name, compared):
    """The bias, Coriolis, centrifugal and weight, is what is left of M a when the efforts are taken away."""
    one, accelerations, biases, of_mujoco = robot(name), [], [], []
    states = one.states(STATES, seed=2)
    for (q, v, effort), found in zip(states, answers(one, states)):
        a = (found["v"] - v) / PERIOD_S
        expected = one.from_pin(pinocchio.aba(one.pin, one.data, one.to_pin(q), one.to_pin(v), one.to_pin(effort)))
        accelerations.append(off(a, expected))
        bias = one.from_pin(pinocchio.nonLinearEffects(one.pin, one.data, one.to_pin(q), one.to_pin(v)))
        biases.append(off(effort - found["mass_matrix"] @ a, bias))
        one.set_mujoco(q, v, effort)
        mujoco.mj_forward(one.mj, one.mj_data)
        of_mujoco.append(off(a, one.from_mujoco(one.mj_data.qacc)))
    compared(f"forward dynamics, {name}", "Pinocchio", accelerations, DIFFERENCE)
    compared(f"bias forces, {name}", "Pinocchio", biases, DIFFERENCE)
    compared(f"forward dynamics, {name}", "MuJoCo", of_mujoco, DIFFERENCE)


@robots
def test_pose_and_twist_of_every_link(name, compared):
    one, poses, twists = robot(name), [], []
    states = one.states(STATES, seed=3)
    for (q, v, _), found in zip(states, answers(one, states)):
        pinocchio.forwardKinematics(one.pin, one.data, one.to_pin(q), one.to_pin(v))
        pinocchio.updateFramePlacements(one.pin, one.data)
        for link, ours_of_link in found["links"].items():
            frame = one.pin.getFrameId(link)
            poses.append(off(ours_of_link["pose"], one.data.oMf[frame].homogeneous[:3].ravel()))
            V = pinocchio.getFrameVelocity(one.pin, one.data, frame, pinocchio.ReferenceFrame.LOCAL)
            twists.append(np.abs(ours_of_link["twist"] - V.vector).max() / np.linalg.norm(v))
    compared(f"link poses, {name}", "Pinocchio", poses, SAME)
    compared(f"link twists, {name}", "Pinocchio", twists, SAME)


@pytest.mark.parametrize("name", ["gantry", "six axes"])
def test_jacobian_of_the_camera(name, compared):
    """The controller's kinematics, which are KDL's, and not the simulator's."""
    one, poses, jacobians, tip = robot(name), [], [], "camera_optical_frame"
    states = one.states(STATES, seed=4)
    found = ours.kinematics(one.urdf, "world", tip, [one.named(q) for q, _, _ in states])
    for (q, _, _), (pose, J) in zip(states, found):
        pinocchio.forwardKinematics(one.pin, one.data, one.to_pin(q))
        expected = pinocchio.computeFrameJacobian(one.pin, one.data, one.to_pin(q), one.pin.getFrameId(tip),
                                                  pinocchio.ReferenceFrame.LOCAL)
        jacobians.append(off(J, one.from_pin(expected)))
        pinocchio.updateFramePlacements(one.pin, one.data)
        poses.append(off(pose, one.data.oMf[one.pin.getFrameId(tip)].homogeneous))
    compared(f"camera pose, {name}", "Pinocchio", poses, SAME)
    compared(f"camera Jacobian, {name}", "Pinocchio", jacobians, SAME)


def test_named_arms(compared):
    masses, jacobians, tip = [], [], "camera_optical_frame"
    for name in ours.ARMS:
        one = robot(name)
        states = one.states(STATES // 5, seed=6)
        found = ours.kinematics(one.urdf, "world", tip, [one.named(q) for q, _, _ in states])
        for (q, _, _), (_, J), answer in zip(states, found, answers(one, states)):
            M = one.matrix_from_pin(pinocchio.crba(one.pin, one.data, one.to_pin(q)))
            masses.append(off(answer["mass_matrix"], M))
            expected = pinocchio.computeFrameJacobian(one.pin, one.data, one.to_pin(q), one.pin.getFrameId(tip),
                                                      pinocchio.ReferenceFrame.LOCAL)
            jacobians.append(off(J, one.from_pin(expected)))
    compared("mass matrix, named arms", "Pinocchio", masses, SAME)
    compared("camera Jacobian, named arms", "Pinocchio", jacobians, 1e-12)


SWINGS = 20
SWING_PERIOD_S, STEPS = 1e-3, 300
#: MuJoCo's integrator Euler is the same scheme: what is left is rounding, which 0.3 s of swing make some 1e4 as large.
SAME_RAD = 1e-9
#: Ours is of first order: half the period must leave half of the difference from the true motion, to this part.
HALF = 0.1


def swings(one, period_s, states):
    """[q] after the same time."""
    steps = round(SWING_PERIOD_S * STEPS / period_s)
    cases = [{"q": one.named(q), "v": one.named(v), "steps": steps} for q, v, _ in states]
    return [found["q"] for found in ours.world(one.urdf, cases, GRAVITY, period_s)]


def gentle(one, seed):
    """States that stay away from the joints' limits, where ours are held."""
    states = []
    for q, v, effort in one.states(SWINGS, seed, speed=0.5):
        middle = 0.5 * (one.lower + one.upper)
        states.append((middle + 0.3 * (q - middle), v, effort))
    return states


def true_motion(one, q, v):
    """q after the same time, by Runge and Kutta's method of fourth order on Pinocchio's accelerations."""
    def slope(y):
        half = len(y) // 2
        return np.r_[y[half:], pinocchio.aba(one.pin, one.data, y[:half], y[half:], np.zeros(half))]

    y, h = np.r_[one.to_pin(q), one.to_pin(v)], SWING_PERIOD_S
    for _ in range(STEPS):
        a = slope(y)
        b = slope(y + 0.5 * h * a)
        c = slope(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(y + h * c))
    return one.from_pin(y[:len(q)])


@robots
def test_swing_step_by_step(name, compared):
    one, differences = robot(name), []
    one.mj.opt.timestep, one.mj.opt.integrator = SWING_PERIOD_S, mujoco.mjtIntegrator.mjINT_EULER
    states = gentle(one, seed=5)
    for (q, v, _), found in zip(states, swings(one, SWING_PERIOD_S, states)):
        one.set_mujoco(q, v)
        mujoco.mj_step(one.mj, one.mj_data, nstep=STEPS)
        differences.append(np.abs(found - one.from_mujoco(one.mj_data.qpos)).max())
    compared(f"free swing, {name}", "MuJoCo, same scheme", differences, SAME_RAD, "rad or m")


@robots
def test_swing_converges_to_the_true_motion(name, compared):
    one, differences = robot(name), []
    states = gentle(one, seed=6)
    coarse, fine = swings(one, SWING_PERIOD_S, states), swings(one, 0.5 * SWING_PERIOD_S, states)
    for (q, v, _), whole, half in zip(states, coarse, fine):
        true = true_motion(one, q, v)
        differences.append(np.abs((half - true) - 0.5 * (whole - true)).max() / np.abs(whole - true).max())
    compared(f"first-order convergence, {name}", "Pinocchio, Runge-Kutta", differences,
             HALF, "of the error")
