"""Law `qp`: the twist of `ibvs` in joint velocities under hard constraints, one quadratic program a look."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Iterable, List, Sequence, Tuple

import numpy as np

from ..features.base import View
from ..ground.types import Status
from .base import register_law
from .constraints import ConstraintSettings, Rooms, rooms_of
from .image import ImageBased
from .look import Arm, Joints

#: A slack above this is reported: the smallest one distinct from rounding [1/s, m/s].
TOLD = 1e-6
#: A constraint is named as one that binds when its multiplier is larger than this part of the largest one.
BINDS = 1e-6
#: Weight of a slack beside the cost of the motion, whose Hessian has entries near 1: a slack is a last resort.
SLACK_WEIGHT = 1e4


@dataclass(frozen=True)
class QpSettings(ConstraintSettings):
    """Settings of law `qp`."""


@register_law("qp", settings=QpSettings)
class QuadraticProgram(ImageBased):
    """min |L (J q_dot - V)|^2 + damping |q_dot - q_dot_0|^2 over the joint velocities, V the twist of `ibvs`.

    q_dot_0 are the joint velocities that the servo would give for V, so that where no constraint binds the arm moves as
    with `ibvs`. Hard are the velocity, the acceleration and the way of each joint, the borders of the view and the
    walls. Limits of the joints are never violated; where they leave no motion that keeps the view and the walls, the
    setting `slack` says what is done, and the status text names the constraint.

    References: N. Mansard, O. Khatib, A. Kheddar, "A unified approach to integrate unilateral constraints in the stack
    of tasks", IEEE T-RO 25(3), 2009. A. D. Ames et al., "Control barrier functions: theory and applications", ECC 2019.
    D. J. Agravante et al., "Visual servoing in an optimization framework for the whole-body control of humanoid
    robots", IEEE RA-L 2(2), 2017.
    """

    moves_joints = continuous_only = True

    def _prepare(self):
        super()._prepare()
        from .._kinematics import solve_program  # C++: not needed to describe the settings of this file
        self._solve, self.needs_plane = solve_program, True

    def joint_velocity(self, view: View, arm: Arm, twist: np.ndarray) -> Joints:
        """`Joints` for one look: see `Law.joint_velocity`."""
        rooms, n = rooms_of(self.settings, view, arm.X_BC), len(arm.q)
        rows = rooms.rows @ arm.jacobian
        H = self.metric(view, arm.jacobian)
        A = np.concatenate([rows, _bounds(n)])
        b = np.concatenate([-min(self.settings.rate_per_s, 1.0 / arm.dt_s) * rooms.h, arm.low, -arm.high])
        q_dot, multipliers, _, feasible = self._solve(H, -H @ arm.wanted, A, b)
        if feasible:
            return self._answer(arm, rooms.names, q_dot, multipliers)
        if not self.settings.slack:
            return self._stand(arm, f"no motion keeps {_listed(asked(rooms, b))}")
        return self._with_slack(arm, rooms, H, A, b)

    def metric(self, view: View, jacobian: np.ndarray) -> np.ndarray:
        """Hessian of the cost, (n, n): rates of the features, each direction relative to their mean size."""
        L = self.features.matrix(view)
        seen = L.T @ L
        seen /= max(seen.trace(), 1e-12) / 6.0
        if not self.features.sees_tilt:  # the servo holds the tilt: as important as the features
            seen[[3, 4], [3, 4]] += 1.0
        H = jacobian.T @ seen @ jacobian
        H /= max(H.trace() / len(H), 1e-12)
        H.flat[::len(H) + 1] += self.settings.damping
        return H

    def relaxed(self, H: np.ndarray, g: np.ndarray, A: np.ndarray, b: np.ndarray,
                which: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
        """Solve min 0.5 x^T H x + g^T x + 0.5 SLACK_WEIGHT |s|^2 over A x >= b, whose first rows have slacks s >= 0.

        Args:
            H, g, A, b: the program, (n, n), (n,), (k, n), (k,).
            which: for each of the first rows of A, the place of its slack in s. Rows of one room may have one slack.
        Returns:
            (x, s, multipliers of the rows of A and then of s >= 0, whether the rows without slack can be kept).
        """
        n, k, m = len(g), len(b), int(which.max(initial=-1)) + 1
        H_s = np.zeros((n + m, n + m))
        H_s[:n, :n], H_s[n:, n:] = H, SLACK_WEIGHT * np.eye(m)
        A_s = np.zeros((k + m, n + m))
        A_s[:k, :n], A_s[k:, n:], A_s[np.arange(len(which)), n + which] = A, np.eye(m), 1.0
        x, multipliers, _, feasible = self._solve(H_s, np.concatenate([g, np.zeros(m)]), A_s,
                                                  np.concatenate([b, np.zeros(m)]))
        return x[:n], x[n:], multipliers, feasible

    def _with_slack(self, arm, rooms, H, A, b):
        """`Joints` that violate view and walls as little as the limits of the joints allow."""
        q_dot, slacks, multipliers, feasible = self.relaxed(H, -H @ arm.wanted, A, b, np.arange(len(rooms.h)))
        if not feasible:
            return self._stand(arm, "the limits of the joints contradict each other")
        joints = self._answer(arm, rooms.names, q_dot, multipliers)
        text = f"infeasible, slack per second: {told(rooms.names, slacks)}"
        return Joints(np.clip(joints.q_dot, arm.low, arm.high), Status.JOINT_LIMIT, text)

    def _stand(self, arm, why):
        return Joints(np.clip(0.0, arm.low, arm.high), Status.JOINT_LIMIT, f"standing still, {why}")

    def _answer(self, arm, rooms, q_dot, multipliers):
        """`Joints`, with the names of the constraints that bind. Args: rooms: names.  multipliers: of them, then of the
        lower and the upper bounds of the joints."""
        if arm.short:
            text = f"braking, too late at the allowed acceleration: {_listed(_joint(name) for name in arm.short)}"
            return Joints(q_dot, Status.JOINT_LIMIT, text)
        n, m = len(arm.q), len(rooms)
        binds = multipliers > BINDS * max(float(multipliers.max(initial=0.0)), BINDS)
        if not binds.any():
            return Joints(q_dot)
        stopped = (binds[m:m + 2 * n].reshape(2, n) & arm.at_stop).any(axis=0)
        if stopped.any():
            names = [_joint(name) for name, held in zip(arm.joint_names, stopped) if held]
            return Joints(q_dot, Status.JOINT_LIMIT, f"at their limits, the others go on: {_listed(names)}")
        names = [name for name, held in zip(rooms, binds) if held]
        names += [_joint(name) for name, held in zip(arm.joint_names, binds[m:m + 2 * n].reshape(2, n).any(axis=0))
                  if held]
        return Joints(q_dot, None, f"servoing, held back by {_listed(names)}")


def told(names: Sequence[str], slacks: Iterable[float]) -> str:
    """In words, which slacks are above rounding, and how large they are."""
    return _listed(f"{name} by {size:.2g}" for name, size in zip(names, slacks) if size > TOLD)


def asked(rooms: Rooms, b: np.ndarray) -> List[str]:
    """Names of the rooms that joint velocities at rest would violate, else of all that is to be kept."""
    asks = [name for name, most in zip(rooms.names, b) if most > 0.0]
    return asks or ["the view and the walls within the limits of the joints"]


@lru_cache(maxsize=16)
def _bounds(n):
    """Rows of the lower and the upper bounds of n joints, (2 n, n); not to be written to."""
    return np.concatenate([np.eye(n), -np.eye(n)])


def _joint(name):
    return f"joint '{name}'"


def _listed(names):
    return ", ".join(names)
