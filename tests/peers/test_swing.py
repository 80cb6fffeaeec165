"""Free swing from random states: the same scheme in MuJoCo, and the true motion by Pinocchio."""
import mujoco
import numpy as np
import ours
import pinocchio
import pytest
from robots import GRAVITY, robot

SWINGS = 20
PERIOD_S, STEPS = 1e-3, 300
#: MuJoCo's integrator Euler is the same scheme: what is left is rounding, which 0.3 s of swing make some 1e4 as large.
SAME_RAD = 1e-9
#: Ours is of first order: half the period must leave half of the difference from the true motion, to this part.
HALF = 0.1

robots = pytest.mark.parametrize("name", sorted(ours.ROBOTS))


def swings(one, period_s, states):
    """[q] after the same time."""
    steps = round(PERIOD_S * STEPS / period_s)
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

    y, h = np.r_[one.to_pin(q), one.to_pin(v)], PERIOD_S
    for _ in range(STEPS):
        a = slope(y)
        b = slope(y + 0.5 * h * a)
        c = slope(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(y + h * c))
    return one.from_pin(y[:len(q)])


@robots
def test_swing_step_by_step(name, compared):
    one, differences = robot(name), []
    one.mj.opt.timestep, one.mj.opt.integrator = PERIOD_S, mujoco.mjtIntegrator.mjINT_EULER
    states = gentle(one, seed=5)
    for (q, v, _), found in zip(states, swings(one, PERIOD_S, states)):
        one.set_mujoco(q, v)
        mujoco.mj_step(one.mj, one.mj_data, nstep=STEPS)
        differences.append(np.abs(found - one.from_mujoco(one.mj_data.qpos)).max())
    compared(f"free swing of 0.3 s, {name}", "MuJoCo, the same scheme", differences, SAME_RAD, "rad or m")


@robots
def test_swing_converges_to_the_true_motion(name, compared):
    one, differences = robot(name), []
    states = gentle(one, seed=6)
    coarse, fine = swings(one, PERIOD_S, states), swings(one, 0.5 * PERIOD_S, states)
    for (q, v, _), whole, half in zip(states, coarse, fine):
        true = true_motion(one, q, v)
        differences.append(np.abs((half - true) - 0.5 * (whole - true)).max() / np.abs(whole - true).max())
    compared(f"free swing of 0.3 s, half the period and half the error, {name}", "Pinocchio, Runge-Kutta", differences,
             HALF, "of the error")
