"""Law `mpc`: the features' way to the goal over a horizon, under hard constraints, one quadratic program a look."""

from dataclasses import dataclass
from itertools import accumulate
from math import expm1
from re import fullmatch
from typing import Iterator, NamedTuple, Tuple

import numpy as np

from ..features.base import View
from ..config.settings import setting
from ..features.points import points
from ..ground.errors import DegenerateFeature
from ..spatial import adjoints, exponentials, inverse, logarithm
from ..ground.types import Status
from .base import register_law
from .constraints import ConstraintSettings, Rooms, points_in_space, rooms_of
from .look import Arm, Joints
from .qp import QuadraticProgram, asked, told

#: Depths below it are predicted as if they were this one [m].
LEAST_DEPTH_M = 0.02
#: A new plan is checked without linearisation when the camera moves by it this much otherwise than by the plan about
#: which it was linearised [m, rad].
STRAIGHT = 0.03
#: A plan that violates a room by more than this in that check is not used [normalised image coordinates, m].
CURVED = 0.02
#: A plan that was made about braking is halved this often at most until it passes the check.
HALVINGS = 5
#: Points of the contour by which an object without followed points is predicted.
CONTOUR = 8


@dataclass(frozen=True)
class MpcSettings(ConstraintSettings):
    """Settings of law `mpc`."""

    horizon: int = setting(10, at_least=1, at_most=50, help="Number of predicted steps.")
    period_s: float = setting(
        0.1, unit="s", above=0,
        help="Length of a predicted step. Each image gives a new plan.")
    moves: int = setting(
        4, at_least=1, at_most=50,
        help="First steps at which the joint velocities may change; then they are constant.")

    def check(self) -> Iterator[str]:
        """Moves are steps of the horizon."""
        if self.moves > self.horizon:
            yield f"moves: found {self.moves}, allowed at most horizon, {self.horizon}"


class Ahead(NamedTuple):
    """Prediction from one look.

    Attributes:
        P: (3, k) points, or points of the contour, in the camera frame now [m].
        now, rooms: `Rooms` now, as `qp` has them, and of P.
        least: (N, m) of `rooms` at each step: 0, or the remainder of one that is violated now.
        names: of the rooms, each once.  which: place in them of each row of a room: of those of now, then (N, m).
    """

    P: np.ndarray
    now: Rooms
    rooms: Rooms
    least: np.ndarray
    names: Tuple[str, ...]
    which: np.ndarray


@register_law("mpc", settings=MpcSettings)
class Predictive(QuadraticProgram):
    """min sum_k |s_k - s_k^d|^2 over the joint velocities of a horizon of N steps.

    s_k^d is what a camera sees that moves by the twist of `ibvs`, which falls with the gains. Points are predicted in
    space, on the way of the last plan, and linearised there; other features with the matrix of the view, and where they
    do not see the tilt, it is one of them. View, walls, ends of the joints, velocities and accelerations are kept at
    every step. A plan that leaves the view or meets a wall when it is predicted without being linearised is made anew
    about standing still, and shortened. Of the plan only the first velocities are commanded.

    Reference: G. Allibert, E. Courtial, F. Chaumette, "Predictive control for constrained image-based visual servoing",
    IEEE T-RO 26(5), 2010 (there by a general solver on the nonlinear problem).
    """

    def _prepare(self):
        super()._prepare()
        config, steps = self.settings, np.arange(self.settings.horizon)
        #: (N, moves): which move holds in which step.
        self._moves = np.eye(config.moves)[np.minimum(steps, config.moves - 1)]
        self._rate = sum(self.gains_per_s) / len(self.gains_per_s)
        times = config.period_s * (steps + 1)
        #: (N,) s for which the twist of the first look would have to be held to come as far.
        self._worth = np.array([-expm1(-self._rate * t) / self._rate for t in times])
        #: (moves,): velocity of each move on that way, relative to that of now.
        self._fall = np.diff(self._worth, prepend=0.0) @ self._moves / self._moves.sum(axis=0) / config.period_s
        #: Whether every feature is the coordinate of a point, whose number and axis are these.
        names = [fullmatch(r"([xy])([0-9]+)", name) for name in self.features.names]
        self._points = all(names) and [2 * (int(name[2]) - 1) + "xy".index(name[1]) for name in names]
        self._plan = self._rows = None

    def _reset(self, reference):
        super()._reset(reference)
        self._plan = None

    def joint_velocity(self, view: View, arm: Arm, twist: np.ndarray) -> Joints:
        """`Joints` for one look: see `Law.joint_velocity`."""
        ahead, n = self._ahead(view, arm), len(arm.q)
        plan = self._nominal(arm)
        H, g, A, b = self._program(view, arm, twist, plan, ahead)
        x, multipliers, _, feasible = self._solve(H, g, A, b)
        if not feasible or self._missed(arm, ahead, x, plan):
            # Rows that are linearised about a plan far past a border contradict each other or say nothing of where the
            # target will be. About the fastest way to a standstill the view hardly changes, and a part of such a plan
            # keeps what all of it does not.
            stop = self._braking(arm)
            H, g, A, b = self._program(view, arm, twist, stop, ahead)
            x, multipliers, _, feasible = self._solve(H, g, A, b)
            for _ in range(HALVINGS if feasible else 0):
                missed = self._missed(arm, ahead, x, stop)
                if not missed:
                    break
                x, multipliers = 0.5 * (x + stop.ravel()), np.zeros(len(multipliers))
                multipliers[:len(ahead.which)] = np.isin(ahead.which, list(missed))
        if not feasible:
            if not self.settings.slack:
                return self._stand(arm, f"no motion keeps {', '.join(asked(ahead.now, b))}")
            return self._least(arm, ahead, H, g, A, b)
        self._plan = x.reshape(-1, n)
        held = np.bincount(ahead.which, multipliers[:len(ahead.which)], len(ahead.names))
        joints = multipliers[len(ahead.which):]
        first, size = joints[:2 * n].reshape(2, n), len(x)
        ends = joints[2 * size:4 * size].reshape(2, -1, n).sum(axis=1)
        arm = arm._replace(at_stop=arm.at_stop | (ends > first))
        return self._answer(arm, ahead.names, self._plan[0], np.concatenate([held, (first + ends).ravel()]))

    def _ahead(self, view, arm):
        """`Ahead` of a view."""
        config, now = self.settings, rooms_of(self.settings, view, arm.X_BC)
        if len(view.features.point_x):
            xy, rooms = np.array(view.shared(points)), now
        else:
            xy = _contour(view, config.extent)
            rooms = _rooms_of_contour(config, xy, now)
        fade = np.exp(-config.rate_per_s * config.period_s * np.arange(1, config.horizon + 1))
        least = np.minimum(rooms.h, 0.0)[None] * fade[:, None]  # one that is violated has to open again
        names = {name: place for place, name in enumerate(dict.fromkeys(now.names))}
        which = np.array([names[name] for name in now.names + rooms.names * config.horizon], dtype=int)
        return Ahead(points_in_space(view, xy), now, rooms, least, tuple(names), which)

    def _missed(self, arm, ahead, x, plan):
        """Places in `Ahead.names` of the rooms that the velocities x, (moves n,), do not keep when nothing is
        linearised. Args: plan: (moves, n) about which they were; near it nothing is missed."""
        config, x = self.settings, x.reshape(plan.shape)
        change = config.period_s * np.cumsum(self._moves @ (x - plan), axis=0) @ arm.jacobian.T
        if np.abs(change).max() < STRAIGHT:
            return set()
        poses = _poses(arm.jacobian, x, config.period_s, config.horizon)[1:]
        seen, _ = predicted_points(ahead.P, poses)
        room = self._rooms_along(ahead, seen, poses) - ahead.least
        return set(ahead.which[len(ahead.now.h):][(room < -CURVED).ravel()])

    def _rooms_along(self, ahead, seen, poses):
        """(N, m) rooms along poses (N, 4, 4). Args: seen: `predicted_points` of them."""
        config = self.settings
        h = [half + sign * seen[:, axis::3] for axis, sign, half, _ in config.borders]
        h.append(seen[:, 2::3] - config.least_depth_m)
        if config.walls:
            normals = ahead.rooms.rows[-len(config.walls):, :3]  # in the camera frame
            h.append(ahead.rooms.h[-len(config.walls):] + poses[:, :3, 3] @ normals.T)
        return np.concatenate(h, axis=1)

    def _program(self, view, arm, twist, plan, ahead):
        """(H, g, A, b) over the joint velocities x of the moves, linearised about a plan, (moves, n): min x' H x / 2 +
        g' x with A x >= b. Rows of A: rooms as `Ahead.which`, then those of `_joint_rows`."""
        n, period_s = len(arm.q), self.settings.period_s
        poses = _poses(arm.jacobian, plan, period_s, self.settings.horizon)
        # Motion of the camera frame of the first step, in it, by the velocities of each move up to each step.
        reach = adjoints(poses[:-1]) @ (period_s * arm.jacobian)
        reach = np.cumsum(self._moves[:, :, None, None] * reach[:, None], axis=0)
        reach = reach.transpose(0, 2, 1, 3).reshape(len(reach), 6, -1)
        h, rows, ways, towards = self._predict(view, twist, poses[1:], ahead)
        flat = plan.ravel()
        M = (ways @ reach).reshape(-1, flat.size)
        target = towards.ravel() + M @ flat
        H, g = M.T @ M, M.T @ target
        scale = max(np.trace(H) / len(H), 1e-12)
        calm = np.outer(self._fall, arm.wanted).ravel()
        H, g = H / scale + self.settings.damping * np.eye(flat.size), g / scale + self.settings.damping * calm
        G = (rows @ reach).reshape(-1, flat.size)
        # The first move keeps what `qp` keeps, too: a step of the horizon is longer than the time between two images.
        # Of a room no more is used up than all of it until the next look.
        now, use_per_s = ahead.now, min(self.settings.rate_per_s, 1.0 / arm.dt_s)
        G_now = np.zeros((len(now.h), flat.size))
        G_now[:, :n] = now.rows @ arm.jacobian
        C, c = self._joint_rows(arm, n)
        A = np.vstack([G_now, G, C])
        return H, -g, A, np.concatenate([-use_per_s * now.h, (ahead.least - h).ravel() + G @ flat, c])

    def _braking(self, arm):
        """(moves, n) joint velocities that bring the arm to rest as fast as the limits of this period and the
        accelerations let it."""
        first = np.clip(0.0, arm.low, arm.high)
        slower = arm.acceleration * self.settings.period_s * np.arange(self.settings.moves)[1:, None]
        return np.vstack([first, np.sign(first) * np.maximum(np.abs(first) - slower, 0.0)])

    def _nominal(self, arm):
        """(moves, n) joint velocities about which the prediction is linearised: the last plan, if it is under way."""
        if self._plan is not None and arm.before.any():
            return self._plan
        return np.outer(self._fall, np.clip(arm.wanted, arm.low, arm.high))

    def _predict(self, view, twist, poses, ahead):
        """Returns the prediction along the nominal way: (slack h of the constraints (N, m), their rows (N, m, 6), rows
        of the features (N, k, 6), their distance from the wanted way (N, k)). Rows refer to the first camera frame."""
        config, L, P = self.settings, self.features.matrix(view), ahead.P
        parts, straight = [], L
        seen, L_seen = predicted_points(P, poses)
        if self._points and len(view.features.point_x):
            axes, straight = [3 * (index // 2) + index % 2 for index in self._points], L[:0]
            wanted, _ = predicted_points(P, exponentials(np.outer(self._worth, twist)))
            parts.append((L_seen[:, axes], wanted[:, axes] - seen[:, axes]))
        if not self.features.sees_tilt:  # the servo holds the tilt: as important as the features
            straight = np.vstack([straight, np.sqrt(np.square(L).sum() / 6.0) * np.eye(6)[3:5]])
        if len(straight):  # features that have no points in space: with one matrix for the whole way
            screws, back = np.array([logarithm(X) for X in poses]), np.array([inverse(X) for X in poses])
            parts.append((straight @ adjoints(back), self._worth[:, None] * (straight @ twist) - screws @ straight.T))
        ways, lack = (np.concatenate(part, axis=1) for part in zip(*parts))
        rows = [sign * L_seen[:, axis::3] for axis, sign, _, _ in config.borders]
        rows.append(L_seen[:, 2::3])
        if config.walls:
            normals = ahead.rooms.rows[-len(config.walls):, :3]
            turns = np.cross(poses[:, None, :3, 3], normals[None])
            rows.append(np.concatenate([np.broadcast_to(normals, turns.shape), turns], axis=2))
        h, rows = self._rooms_along(ahead, seen, poses), np.concatenate(rows, axis=1)
        if not (np.isfinite(h).all() and np.isfinite(ways).all()):
            raise DegenerateFeature("mpc: a predicted view is not finite")
        return h, rows, ways, lack

    def _joint_rows(self, arm, n):
        """(C, c): rows C u >= c. The first 2 n are of this period; then come the velocities of the other moves, the
        ends of the ways after each move (lower, then upper ones), and the accelerations."""
        moves, period_s = self.settings.moves, self.settings.period_s
        if self._rows is None:
            whole = np.eye(moves * n)
            lasts = np.full(moves, period_s)
            lasts[-1] = period_s * (self.settings.horizon - moves + 1)
            sums = np.kron(np.tril(np.ones((moves, moves))) * lasts, np.eye(n))
            changes = (whole - np.eye(moves * n, k=-n))[n:]
            self._rows = np.vstack([whole[:n], -whole[:n], whole[n:], -whole[n:], sums, -sums, changes, -changes])
        change = np.tile(arm.acceleration * period_s, moves - 1)
        speeds = np.tile(arm.velocity, moves - 1)
        below = np.tile(np.minimum(arm.lower - arm.q, 0.0), moves)
        above = np.tile(np.minimum(arm.q - arm.upper, 0.0), moves)
        return self._rows, np.concatenate([arm.low, -arm.high, -speeds, -speeds, below, above, -change, -change])

    def _least(self, arm, ahead, H, g, A, b):
        """`Joints` of the plan that violates view and walls least; one slack for each name, over the whole horizon."""
        u, slacks, _, feasible = self.relaxed(H, g, A, b, ahead.which)
        if not feasible:  # the joints cannot brake before their ends within the horizon
            return self._stand(arm, "the limits of the joints contradict each other over the horizon")
        self._plan = u.reshape(-1, len(arm.q))
        return Joints(np.clip(self._plan[0], arm.low, arm.high), Status.JOINT_LIMIT,
                      f"infeasible, slack within the horizon: {told(ahead.names, slacks)}")

    def _stand(self, arm, why):
        self._plan = None
        return super()._stand(arm, why)


def _contour(view, extent):
    """(CONTOUR, 2) points about the ellipse of the object's moments, `extent` standard deviations from its middle."""
    f, mu = view.features, view.mu
    n = np.array([[mu["20"], mu["11"]], [mu["11"], mu["02"]]]) / f.area
    if not (np.isfinite(n).all() and n[0, 0] > 0.0 and np.linalg.det(n) > 0.0):
        raise DegenerateFeature("constraints: the object has no extent in this view")
    angles = 2.0 * np.pi * np.arange(CONTOUR) / CONTOUR
    # Outside the ellipse, so that the polygon of the points contains it.
    circle = np.column_stack([np.cos(angles), np.sin(angles)]) / np.cos(np.pi / CONTOUR)
    return (f.xg, f.yg) + extent * circle @ np.linalg.cholesky(n).T


def _rooms_of_contour(config, xy, plain):
    """`Rooms` now of the points of a contour, with the walls of `plain`; their rows are those of the walls alone."""
    names, h = [], []
    for axis, sign, half, border in config.borders:
        names += [f"the object at the {border} border"] * len(xy)
        h.append(half + sign * xy[:, axis])
    names += ["the object before the camera"] * len(xy)
    walls, depth = len(config.walls), plain.h[-len(config.walls) - 1]
    h += [np.full(len(xy), depth), plain.h[len(plain.h) - walls:]]
    return Rooms((*names, *plain.names[len(plain.h) - walls:]), np.concatenate(h), plain.rows)


def predicted_points(P: np.ndarray, poses: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the view of a moved camera of points at rest: (x1, y1, Z1, ..., (N, 3 n); their rows, (N, 3 n, 6)).

    Args: P: (3, n) in the first camera frame [m].  poses: (N, 4, 4) of the camera in that frame. Rows are of twists of
        the first frame before the way.
    """
    R, p = poses[:, :3, :3].transpose(0, 2, 1), poses[:, :3, 3]
    X, Y, Z = (R @ (P[None] - p[:, :, None])).transpose(1, 0, 2)
    depth = np.maximum(Z, LEAST_DEPTH_M)
    x, y = X / depth, Y / depth
    slope = np.zeros((*Z.shape, 3, 3))
    slope[..., 0, 0] = slope[..., 1, 1] = 1.0 / depth
    slope[..., 0, 2], slope[..., 1, 2], slope[..., 2, 2] = -x / depth, -y / depth, 1.0
    # In the first frame a point moves by -(v + w x P), seen from the camera; then it is turned and projected.
    X, Y, Z = P
    moved = np.zeros((len(X), 3, 6))
    moved[:, [0, 1, 2], [0, 1, 2]] = -1.0
    moved[:, 0, 4], moved[:, 0, 5], moved[:, 1, 3], moved[:, 1, 5], moved[:, 2, 3], moved[:, 2, 4] = -Z, Y, Z, -X, -Y, X
    rows = (slope @ R[:, None] @ moved).reshape(len(poses), -1, 6)
    return np.stack([x, y, depth], axis=2).reshape(len(poses), -1), rows


def _poses(jacobian, plan, period_s, horizon):
    """(N + 1, 4, 4) poses of the camera in its first frame, along joint velocities (moves, n). Each of these is held
    for a step, and the last one until the horizon of N steps ends."""
    steps = list(exponentials(period_s * (plan @ jacobian.T)))
    steps += steps[-1:] * (horizon - len(steps))
    return np.array(list(accumulate([np.eye(4), *steps], np.matmul)))
