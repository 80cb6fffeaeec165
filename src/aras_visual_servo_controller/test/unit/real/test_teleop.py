"""Keyboard teleoperation: what keys do, when it stops, and a terminal's characters."""

import os
import pty
import termios
from types import SimpleNamespace

import numpy as np
import pytest

from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo_controller.real.teleop import FASTER, HOLD_S, LOOK_AHEAD_S, Keys, Teleop

NAMES = ("a", "b", "c", "d", "e", "f")
JACOBIAN = np.array([[1, 0.2, 0, 0, 0, 0], [0, 1, 0.3, 0, 0, 0], [0, 0, 1, 0, 0, 0.1],
                     [0, 0, 0, 2, 0.5, 0], [0.1, 0, 0, 0, 2, 0], [0, 0, 0, 0, 0, 2.0]])
REST = np.zeros(6)


def make(**limits):
    values = {"lower": np.full(6, -1.0), "upper": np.full(6, 1.0), "velocity": np.full(6, 5.0), **limits}
    return Teleop(SimpleNamespace(joint_names=NAMES, jacobian=lambda q: JACOBIAN, **values))


def test_a_held_key_moves_the_chosen_joint_and_only_it():
    teleop = make()
    teleop.press("3", 0.0)
    np.testing.assert_array_equal(teleop.velocity(REST, 0.0), REST, "choosing does not move")
    teleop.press("a", 1.0)
    np.testing.assert_allclose(teleop.velocity(REST, 1.0 + 0.9 * HOLD_S), [0, 0, -0.3, 0, 0, 0])


def test_it_stops_when_no_key_is_held_and_at_the_stop_key():
    teleop = make()
    teleop.press("d", 1.0)
    np.testing.assert_array_equal(teleop.velocity(REST, 1.0 + 1.1 * HOLD_S), REST)
    teleop.press("d", 2.0)
    teleop.press(" ", 2.0)
    np.testing.assert_array_equal(teleop.velocity(REST, 2.0), REST)


@pytest.mark.parametrize("key, row, speed", [
    ("d", 0, 0.05), ("a", 0, -0.05), ("s", 1, 0.05), ("w", 1, -0.05), ("e", 2, 0.05), ("q", 2, -0.05), ("i", 3, 0.2),
    ("k", 3, -0.2), ("l", 4, 0.2), ("j", 4, -0.2), ("o", 5, 0.2), ("u", 5, -0.2)])
def test_in_camera_mode_the_camera_gets_the_twist_of_the_key(key, row, speed):
    teleop = make()
    teleop.press("\t", 0.0)
    teleop.press(key, 0.0)
    twist = np.zeros(6)
    twist[row] = speed
    np.testing.assert_allclose(JACOBIAN @ teleop.velocity(REST, 0.0), twist, atol=1e-12)


def test_speed_keys_scale_and_velocity_limits_hold():
    teleop = make(velocity=np.full(6, 0.35))
    for key in "+d":
        teleop.press(key, 0.0)
    assert teleop.velocity(REST, 0.0)[0] == pytest.approx(min(0.3 * FASTER, 0.35))
    for key in "--d":
        teleop.press(key, 0.0)
    assert teleop.velocity(REST, 0.0)[0] == pytest.approx(0.3 / FASTER)


def test_a_joint_stops_before_its_limit_and_leaves_it_again():
    teleop = make()
    near = np.array([1.0 - 0.5 * LOOK_AHEAD_S * 0.3, 0, 0, 0, 0, 0])
    teleop.press("d", 0.0)
    np.testing.assert_array_equal(teleop.velocity(near, 0.0), REST)
    teleop.press("a", 0.0)
    assert teleop.velocity(near, 0.0)[0] == -0.3


@pytest.mark.parametrize("keys, q", [("\td", [0.9999, 0, 0, 0, 0, 0]), ("d", [0, 0, np.nan, 0, 0, 0])],
                         ids=["the camera rather than going elsewhere", "positions that are not finite"])
def test_it_stops_where_it_cannot_do_as_told(keys, q):
    teleop = make()
    for key in keys:
        teleop.press(key, 0.0)
    np.testing.assert_array_equal(teleop.velocity(np.array(q), 0.0), REST)


def test_meaningless_keys_are_ignored_and_x_quits():
    teleop = make()
    for key in "7z\x00%":
        teleop.press(key, 0.0)
    np.testing.assert_array_equal(teleop.velocity(REST, 0.0), REST)
    assert not teleop.quit
    teleop.press("x", 0.0)
    assert teleop.quit


def test_bad_speeds_are_all_named():
    with pytest.raises(ParameterError, match="joint_speed.*\n.*angular_rad_per_s"):
        Teleop(SimpleNamespace(joint_names=NAMES), joint_speed=0.0, angular_rad_per_s=float("nan"))


def test_keys_of_a_terminal_come_one_by_one_and_the_terminal_is_put_back():
    master, slave = pty.openpty()
    try:
        before = termios.tcgetattr(slave)
        with Keys(slave) as keys:
            assert keys.read(0.0) == ""
            os.write(master, b"d")
            assert keys.read(5.0) == "d", "no line is waited for"
            os.write(master, b"\x1b[A")
            assert keys.read(5.0) == "", "arrow keys mean nothing"
            os.write(master, b"\t1")
            assert keys.read(5.0) == "\t1"
        assert termios.tcgetattr(slave) == before
    finally:
        os.close(master)
        os.close(slave)


def test_standard_input_that_is_no_terminal_is_refused():
    read, write = os.pipe()
    with pytest.raises(ParameterError, match="terminal"):
        Keys(read)
    os.close(read)
    os.close(write)
