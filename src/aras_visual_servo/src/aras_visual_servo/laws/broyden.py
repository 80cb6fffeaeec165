"""Law `broyden`: the image Jacobian learnt on the way, without calibration (docs/theory.md T32)."""

from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..config.settings import setting
from ..ground.errors import ParameterError
from .base import Law, register_law, sampled_gains

#: A test move lasts this many images of motion and then this many at rest, in which the joints catch up.
MOVE_IMAGES, REST_IMAGES = 3, 4
#: No image asks for a motion of more than this many times `move`, because the learnt matrix holds nearby only.
TRUST = 5.0


@dataclass(frozen=True)
class BroydenSettings:
    """Settings of law `broyden`, which works in mode `continuous` only."""

    initial: str = setting(
        "desired", choices=("desired", "moves"),
        help="First matrix: `desired` is that of the goal; `moves` estimates it by a small test move along each axis.")
    forgetting: float = setting(
        0.95, above=0, at_most=1,
        help="Factor rho on the weight of earlier images at each image (T32); 1: forgets nothing.")
    move: float = setting(0.01, above=0, help="Size of a test move: an angle in radians, a translation in parts of Z*.")


@register_law("broyden", settings=BroydenSettings)
class Broyden(Law):
    """v = -J^+ Lambda e, with J estimated from how the features changed after each twist.

    The estimate is recursive least squares with forgetting (T32, with references). It starts from the matrix at the
    goal (`desired`), or from nothing (`moves`: one small test move along each axis comes first), and uses no other
    knowledge of the camera, the depth or the plane. In the estimate rotations count in radians and translations in
    parts of Z*.
    """

    works_on, continuous_only, foresees = None, True, False

    def _prepare(self):
        self._forgetting, self._move = self.settings.forgetting, self.settings.move
        self._columns = np.arange(6) if self.features.sees_tilt else np.array([0, 1, 2, 5])
        self._J = self._units = None

    @property
    def L(self) -> Optional[np.ndarray]:
        """Estimate of the interaction matrix, (k, 6); None until the test moves are done."""
        if self._J is None:
            return None
        L = np.zeros((len(self.features), 6))
        L[:, self._columns] = self._J / self._units
        return L

    def _reset(self, reference):
        view, plane = self.taught_view(reference)
        self._units = np.array([view.z_star_m] * 3 + [1.0] * 3)[self._columns]
        n = len(self._columns)
        self._P, self._P_trace = np.eye(n) / self._move**2, n / self._move**2
        self._s_last = self._dt_last = None
        self._images, self._motions, self._changes = 0, np.zeros((n, n)), np.zeros((len(self.features), n))
        self._J = None
        if self.settings.initial == "desired":
            self._J = self.goal_matrix(view, plane)[:, self._columns] * self._units

    def _twist(self, look, s, e):
        dt_s = look.dt_s
        if dt_s <= 0.0:
            raise ParameterError(f"law '{self.name}': found dt_s {dt_s}, allowed > 0, because the law learns from how "
                                 "far each twist moves the camera")
        motion, change = self._since_the_last_image(look, s)
        self._s_last, self._dt_last = s, dt_s
        if self._J is None:
            self._note(motion, change)
        elif motion is not None:
            self._learn(motion, change)
        if self._J is None:
            return self._test_move(dt_s)
        twist = -(self.invert(self.L) @ (np.array(sampled_gains(self.gains_per_s, dt_s)) * e))
        motion = twist[self._columns] / self._units
        return twist * min(1.0, TRUST * self._move / max(float(motion @ motion) ** 0.5 * dt_s, 1e-12))

    def _since_the_last_image(self, look, s):
        """(motion (n,), change of the features (k,)); (None, None) at the first image and after the arm was stopped."""
        if look.applied is None or self._s_last is None:
            return None, None
        motion = look.applied[self._columns] / self._units * self._dt_last
        return motion, np.array(self.features.error(s, self._s_last, self._symmetric(look.view)))

    def _learn(self, motion, change):
        """One step of recursive least squares (T32).

        While the arm rests, forgetting would make the covariance grow without bound; it is kept to its first trace.
        """
        Ph = self._P @ motion
        scale = 1.0 / (self._forgetting + float(motion @ Ph))
        self._J = self._J + np.outer(change - self._J @ motion, scale * Ph)
        P = (self._P - np.outer(Ph, scale * Ph)) / self._forgetting
        self._P = P * min(1.0, self._P_trace / float(np.trace(P)))

    def _note(self, motion, change):
        """Adds a measurement to the sums of the current test move. After the last move, solves for the matrix."""
        n = len(self._columns)
        axis = (self._images - 1) // (MOVE_IMAGES + REST_IMAGES)
        if motion is not None and 0 <= axis < n:
            self._motions[:, axis] += motion
            self._changes[:, axis] += change
        if self._images == n * (MOVE_IMAGES + REST_IMAGES):
            self._J = self._changes @ np.linalg.pinv(self._motions)
        self._images += 1

    def _test_move(self, dt_s):
        """Twist (6,) of the current test move: along one axis, or zero while the joints catch up."""
        axis, image = divmod(self._images - 1, MOVE_IMAGES + REST_IMAGES)
        twist = np.zeros(6)
        if image < MOVE_IMAGES:
            twist[self._columns[axis]] = self._move * self._units[axis] / (MOVE_IMAGES * dt_s)
        return twist
