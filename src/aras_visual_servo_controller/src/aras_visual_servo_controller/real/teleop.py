"""Keyboard teleoperation: from keys to joint velocities. No ROS and no clock; only `Keys` reads a terminal."""

import os
import select
import termios
import tty
from typing import Any

import numpy as np

from aras_visual_servo import ParameterError, TwistInverse

HOLD_S = 0.15       # a key counts as held this long after its last character; terminals repeat at 25 Hz and more
LOOK_AHEAD_S = 0.2  # a joint that would reach its limit within this time stops
FASTER = 1.25       # factor of one key press
ESCAPE_S = 0.02     # a terminal sends the rest of an escape sequence within this time
HELP = """Tab: joints or camera   + -: faster, slower   space: stop   x: quit
joints: 1 .. 9 choose, d a: up, down   camera: d a: x, s w: y, e q: z, i k: about x, l j: about y, o u: about z"""

#: Key -> (row of the camera's twist, sign).
CAMERA_KEYS = {"d": (0, 1), "a": (0, -1), "s": (1, 1), "w": (1, -1), "e": (2, 1), "q": (2, -1),
               "i": (3, 1), "k": (3, -1), "l": (4, 1), "j": (4, -1), "o": (5, 1), "u": (5, -1)}
JOINT_KEYS = {"d": 1, "a": -1}


class Teleop:
    """Motion of the arm while keys are held.

    Attributes:
        mode: "joints" or "camera".  joint: name of the joint that is moved in mode "joints".
        quit: True once the key for it was pressed.
    """

    def __init__(self, kinematics: Any, joint_speed: Any = 0.3, linear_m_per_s: float = 0.05,
                 angular_rad_per_s: float = 0.2) -> None:
        """Set up.

        Args:
            kinematics: `Kinematics` of the chain to the camera.
            joint_speed: [m/s or rad/s].  linear_m_per_s, angular_rad_per_s: of the camera. All > 0.
        Raises: ParameterError: a speed is not above zero, all of them listed.
        """
        speeds = {"joint_speed": joint_speed, "linear_m_per_s": linear_m_per_s, "angular_rad_per_s": angular_rad_per_s}
        faults = [f"{name}: found {value}, allowed > 0" for name, value in speeds.items()
                  if not 0.0 < value < float("inf")]
        if faults:
            raise ParameterError("\n".join(faults))
        self._kinematics = kinematics
        self._invert = TwistInverse(np.ones(len(kinematics.joint_names)))
        self._joint_speed = joint_speed
        self._twist_speed = np.array([linear_m_per_s] * 3 + [angular_rad_per_s] * 3)
        self._scale = 1.0
        self._key, self._pressed_s = None, -float("inf")
        self.mode, self.joint, self.quit = "joints", kinematics.joint_names[0], False

    def press(self, key: str, now_s: float) -> None:
        """A key came, at a time of any steady clock [s]. Keys without a meaning are ignored."""
        names = self._kinematics.joint_names
        if key == "\t":
            self.mode, self._key = ("camera" if self.mode == "joints" else "joints"), None
        elif key in "+=":
            self._scale *= FASTER
        elif key == "-":
            self._scale /= FASTER
        elif key in ("x", "\x03"):
            self.quit, self._key = True, None
        elif key == " ":
            self._key = None
        elif self.mode == "joints" and key.isdigit() and 1 <= int(key) <= len(names):
            self.joint, self._key = names[int(key) - 1], None
        elif key in (JOINT_KEYS if self.mode == "joints" else CAMERA_KEYS):
            self._key, self._pressed_s = key, now_s

    def velocity(self, q: np.ndarray, now_s: float) -> np.ndarray:
        """Joint velocities.

        Args: q: (n,) joint positions.  now_s: time, of the clock of `press`.
        Returns: (n,) [m/s or rad/s], within the velocity limits; zeros when no key is held or q is not finite.
        """
        rest = np.zeros(len(self._kinematics.joint_names))
        if self._key is None or not 0.0 <= now_s - self._pressed_s <= HOLD_S or not np.isfinite(q).all():
            return rest
        if self.mode == "joints":
            wanted = rest.copy()
            wanted[self._kinematics.joint_names.index(self.joint)] = (
                JOINT_KEYS[self._key] * self._scale * self._joint_speed)
        else:
            row, sign = CAMERA_KEYS[self._key]
            twist = np.zeros(6)
            twist[row] = sign * self._scale * self._twist_speed[row]
            wanted = self._invert(self._kinematics.jacobian(q)).joint_velocity(twist)
        fastest = float(np.max(np.abs(wanted) / self._kinematics.velocity))
        if fastest > 1.0:
            wanted = wanted / fastest
        ahead = q + LOOK_AHEAD_S * wanted
        beyond = ((ahead > self._kinematics.upper) & (wanted > 0)) | ((ahead < self._kinematics.lower) & (wanted < 0))
        if self.mode == "camera":  # another direction of the camera than the one asked for would be a surprise
            return rest if beyond.any() else wanted
        return np.where(beyond, 0.0, wanted)

    def status(self) -> str:
        """One line for the screen."""
        what = self.joint if self.mode == "joints" else "x y z and turns of the camera"
        return f"{self.mode}: {what}, speed {self._scale:.2f}"


class Keys:
    """Characters of a terminal, unbuffered and without echo. As a context manager it puts the terminal back."""

    def __init__(self, descriptor: int) -> None:
        """Args: descriptor of a terminal. Raises ParameterError if it is none."""
        if not os.isatty(descriptor):
            raise ParameterError("teleop: standard input is no terminal, allowed a terminal")
        self._descriptor = descriptor
        self._before: Any = None

    def __enter__(self) -> "Keys":
        self._before = termios.tcgetattr(self._descriptor)
        tty.setcbreak(self._descriptor)
        return self

    def __exit__(self, *_: Any) -> None:
        termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._before)

    def read(self, timeout_s: float) -> str:
        """Characters that came within timeout_s, "" if none did; escape sequences (arrow keys) are left out."""
        if not select.select([self._descriptor], [], [], timeout_s)[0]:
            return ""
        text = os.read(self._descriptor, 64).decode("ascii", "ignore")
        if text.startswith("\x1b"):
            while select.select([self._descriptor], [], [], ESCAPE_S)[0] and os.read(self._descriptor, 64):
                pass
            return ""
        return text
