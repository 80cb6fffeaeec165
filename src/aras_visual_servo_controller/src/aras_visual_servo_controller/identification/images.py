"""Fits what images of a resting board tell of a moving arm: image delay, joint offsets, backlash, lens, hand-eye, size.

All views are fitted at once, as bundle adjustment does (Triggs et al., Vision Algorithms, 1999). The joint positions
are those of the time at which an image was exposed, so that the delay of the images is a parameter like the others.
"""

from dataclasses import dataclass, replace
from typing import Dict, List

import numpy as np
from scipy.optimize import least_squares

from aras_visual_servo import ParameterError, RobotKinematics
from aras_visual_servo.spatial import exponential, inverse, rotation_vector, rpy_of
from ..calibration.boards import Board
from ..calibration.camera import CameraCalibration
from .advice import LEAST_SPAN
from .estimates import Estimate, Identified, Unknown, covariance
from .recording import Recording

#: Fewest views of the board, and part of the views, at the end, that is not fitted.
FEWEST_VIEWS, HELD_OUT = 12, 0.25
#: Delays from which the fit starts, and the longest one. [s]
STARTS_S, LONGEST_DELAY_S = (0.0, 0.05, 0.1, 0.2), 0.5
#: A place of the model may be off by this: [m] and [rad]; a focal length and a size by this part.
PLACE_M, PLACE_RAD, PART = 0.05, 0.2, 0.1
#: The prior of a parameter is its scale, against this error of a corner. It keeps what the views do not tell. [px]
PRIOR_PX = 0.05
#: A parameter is told if the views leave less than this part of its scale, and two are one if they correlate so much.
TOLD, SHARED = 0.2, 0.3
#: Residuals may be correlated over this many views.
LAGS = 3
IMAGE_DELAY, SIZE = "image_delay_s", "target.size_m"
INTRINSICS = ("camera.fx", "camera.fy", "camera.cx", "camera.cy")
HAND_EYE = tuple(f"hand_eye.{key}" for key in ("x", "y", "z", "turn_x", "turn_y", "turn_z"))
TARGET = tuple(f"target.{key}" for key in ("x", "y", "z", "turn_x", "turn_y", "turn_z"))
OFFSET, BACKLASH = ".offset", ".backlash"
#: Scale of a backlash, and the play with which the search for it begins. [m or rad]
PLAY, FIRST_PLAY = 0.02, 2e-3
#: Fits of the backlash; each knows the play of the one before. It is kept above so many of its standard deviations.
PLAY_ROUNDS, SIGNIFICANT = 3, 5.0


@dataclass(frozen=True)
class Sightings:
    """Attributes: times_s: (f,) stamps of the images.  pixels: (f, n, 2) of the board's points."""

    times_s: np.ndarray
    pixels: np.ndarray


@dataclass(frozen=True)
class SeenArm:
    """What images tell of an arm.

    Attributes:
        identified: `image_delay_s` [s], `JOINT.offset` (true minus reported position [m or rad]), `JOINT.backlash`
        where it shows (full play between reported and true position [m or rad]), `camera.fx`, fy, cx, cy [px],
        `hand_eye.x` to `turn_z` (from the model's camera frame to the true one, in the former [m, rad]), and
        `target.size_m`.
        held_out_px, residual_px: root mean square distance of the corners in the views that were not fitted, and in
        the others [px].
        camera: with the fitted intrinsics.  X_CC: (4, 4) true camera in the model's camera frame.
    """

    identified: Identified
    held_out_px: float
    residual_px: float
    camera: CameraCalibration
    X_CC: np.ndarray

    def hand_eye(self, X_FC: np.ndarray) -> Dict[str, List[float]]:
        """Returns position_m and rpy_rad of `robot.hand_eye`. Args: X_FC: (4, 4) the model's camera on its link."""
        X = X_FC @ self.X_CC
        return {"position_m": X[:3, 3].tolist(), "rpy_rad": list(rpy_of(X[:3, :3]))}


def identify_images(recording: Recording, sightings: Sightings, board: Board, camera: CameraCalibration,
                    kinematics: RobotKinematics) -> SeenArm:
    """Returns what the views of a board that rests tell of the arm that carries the camera.

    What only changes together with the place of the board or of the camera is unknown: the offset of the first joint,
    and of the last one. They stay zero.

    Args: camera: as camera_info has it.  kinematics: of the model, camera included.
    Raises: ParameterError: too few views, or joints that are not those of the kinematics.
    """
    faults = []
    if set(recording.joint_names) != set(kinematics.joint_names):
        faults.append(f"joint_names: found {sorted(recording.joint_names)}, allowed {sorted(kinematics.joint_names)}")
    first, last = recording.times_s[0] + LONGEST_DELAY_S, recording.times_s[-1]
    used = (sightings.times_s > first) & (sightings.times_s < last)
    if np.count_nonzero(used) < FEWEST_VIEWS:
        faults.append(f"images: found {np.count_nonzero(used)} with the board wholly in view later than "
                      f"{LONGEST_DELAY_S} s after the first joint state, allowed at least {FEWEST_VIEWS}")
    if faults:
        raise ParameterError(faults)
    chosen = Sightings(sightings.times_s[used], sightings.pixels[used])
    return _Views(recording, chosen, board, camera, kinematics).result()


class _Views:
    def __init__(self, recording, sightings, board, camera, kinematics):
        self._recording, self._board, self._camera, self._kinematics = recording, board, camera, kinematics
        self._order = [recording.joint_names.index(name) for name in kinematics.joint_names]
        self._times, self._pixels = sightings.times_s, sightings.pixels
        self._offsets, self._plays = ([name + end for name in kinematics.joint_names] for end in (OFFSET, BACKLASH))
        self._names = (IMAGE_DELAY, *self._offsets, *INTRINSICS, *HAND_EYE, SIZE, *TARGET, *self._plays)
        place = [PLACE_M] * 3 + [PLACE_RAD] * 3
        self._scale = np.array([0.02] + [PLACE_RAD] * len(self._offsets) + [PART * camera.K[0, 0]] * 4 + place
                               + [PART * board.size_m] + place + [PLAY] * len(self._plays))
        self._reported = recording.position[:, self._order]
        self._sides = np.zeros_like(self._reported)
        self._fit = np.arange(len(self._times)) < round(len(self._times) * (1.0 - HELD_OUT))
        self._X_BO = kinematics.camera(self._joints(self._times[:1])[0]) @ camera.pose_of(self._pixels[0], board)

    def _joints(self, times, plays=0.0):
        """(f, m) reported positions in the order of the kinematics, less half of the plays (m,) where they move to."""
        q, stamps = self._reported - 0.5 * plays * self._sides, self._recording.times_s
        return np.column_stack([np.interp(times, stamps, column) for column in q.T])

    def _parts(self, x):
        """(delay, offsets, intrinsics, X_CC, size, X_BO, plays) of all parameters in units of their scales."""
        v, m = x * self._scale, len(self._offsets)
        intrinsics = self._camera.intrinsics.copy()
        intrinsics[:4] += v[1 + m:5 + m]
        return (v[0], v[1:1 + m], intrinsics, exponential(v[5 + m:11 + m]), self._board.size_m + v[11 + m],
                self._X_BO @ exponential(v[12 + m:18 + m]), v[18 + m:])

    def errors(self, x, rows):
        """(f, n, 2) projected minus seen [px]."""
        delay, offsets, intrinsics, X_CC, size, X_BO, plays = self._parts(x)
        points = self._board.points_m * (size / self._board.size_m)
        joints = self._joints(self._times[rows] - delay, plays) + offsets
        poses = [inverse(self._kinematics.camera(q) @ X_CC) @ X_BO for q in joints]
        return np.stack([self._camera.project(points, X_CO, intrinsics) for X_CO in poses]) - self._pixels[rows]

    def _solve(self, start, free, rows):
        """(values, Jacobian of the errors by the free ones, cost) of the fit of some rows."""
        def whole(part):
            x = start.copy()
            x[free] = part
            return x

        def residuals(part):
            return np.append(self.errors(whole(part), rows).ravel(), PRIOR_PX * part)
        found = least_squares(residuals, start[free], x_scale="jac", method="lm", diff_step=1e-6)
        return whole(found.x), found.jac[:-len(found.x)], 2.0 * found.cost

    def result(self):
        """`SeenArm` of the fitted values."""
        rows, k = np.nonzero(self._fit)[0], len(self._names)
        few = rows[::max(1, len(rows) // FEWEST_VIEWS)]
        plain = np.array([name not in (*self._offsets, *self._plays, *INTRINSICS, SIZE) for name in self._names])

        def begun(delay):
            x = np.zeros(k)
            x[0] = delay / self._scale[0]
            return self._solve(x, plain, few)
        x = min((begun(delay) for delay in STARTS_S), key=lambda each: each[2])[0]
        free, unknown = np.array([name not in self._plays for name in self._names]), {}
        x, jac, _ = self._solve(x, free, rows)
        # Offsets give way to the places of camera and board, which are what is wanted.
        for group in (self._offsets, (*INTRINSICS, SIZE), (IMAGE_DELAY, *HAND_EYE)):
            lost = self._open([name for name, each in zip(self._names, free) if each], jac, x, rows, group)
            if lost:
                unknown.update(lost)
                gone = np.array([name in lost for name in self._names])
                x, free = np.where(gone, 0.0, x), free & ~gone
                x, jac, _ = self._solve(x, free, rows)
        x, jac, free = self._with_backlash(x, jac, free, rows)
        names = [name for name, each in zip(self._names, free) if each]
        delay, offsets, intrinsics, X_CC, size, _, plays = self._parts(x)
        turn = rotation_vector(X_CC[:3, :3])
        wanted, joints = [name for name in self._names if name not in TARGET], ["m or rad"] * len(offsets)
        values = dict(zip(wanted, (delay, *offsets, *intrinsics[:4], *X_CC[:3, 3], *turn, size, *plays)))
        units = dict(zip(wanted, ("s", *joints, *["px"] * 4, *["m"] * 3, *["rad"] * 3, "m", *joints)))
        estimates = {name: Estimate(float(values[name]), float(stddev), units[name])
                     for name, stddev in zip(names, self._stddev(x, jac, free, rows)) if name in values}
        error = self.errors(x, rows)
        held = np.nonzero(~self._fit)[0]
        K = np.array([[intrinsics[0], 0.0, intrinsics[2]], [0.0, intrinsics[1], intrinsics[3]], [0.0, 0.0, 1.0]])
        rms = _rms(error)
        return SeenArm(Identified(estimates, [Unknown(name, others, _motion(name)) for name, others in unknown.items()],
                                  {"images": rms}),
                       _rms(self.errors(x, held)), rms, replace(self._camera, K=K), X_CC)

    def _stddev(self, x, jac, free, rows):
        """(k,) standard deviations of the free parameters in their units."""
        error, n, k = self.errors(x, rows), len(rows), np.count_nonzero(free)
        groups = np.repeat(np.arange(error[0].size), n)
        by_point = jac.reshape(n, -1, k).transpose(1, 0, 2).reshape(-1, k)
        variance = float(np.mean(error**2))
        back = np.linalg.solve(by_point.T @ by_point + variance * np.eye(k), by_point.T)
        return np.sqrt(np.diag(covariance(back, error.reshape(n, -1).T.ravel(), groups, LAGS))) * self._scale[free]

    def _with_backlash(self, x, jac, free, rows):
        """(values, Jacobian, free parameters) with the backlash of each joint that shows it.

        The reported position is that of the motor. The link follows it at the end of the play.
        """
        plays = np.array([name in self._plays for name in self._names])
        moved = np.isin(self._names, [name for name, span in zip(self._plays, np.ptp(self._reported, axis=0))
                                      if span > LEAST_SPAN])
        wider, begun = free | (plays & moved), x
        while np.any(wider & plays):
            for _ in range(PLAY_ROUNDS):
                width = np.maximum(begun[plays] * self._scale[plays], FIRST_PLAY)
                self._sides = 2.0 * (self._reported - _followed(self._reported, width)) / width
                begun, wide, _ = self._solve(begun, wider, rows)
            stddev = np.full(len(free), np.inf)
            stddev[wider] = self._stddev(begun, wide, wider, rows)
            weak = wider & plays & (begun * self._scale < SIGNIFICANT * stddev)
            if not np.any(weak):
                return begun, wide, wider
            wider, begun = wider & ~weak, np.where(weak, 0.0, begun)
        return x, jac, free

    def _open(self, names, jac, x, rows, group):
        """Name -> those it cannot be told from, of the parameters of a group that the views tell no better than the
        model does."""
        variance = max(float(np.mean(self.errors(x, rows)**2)), PRIOR_PX**2)
        after = np.linalg.inv(jac.T @ jac / variance + np.eye(len(names)))
        spread = np.sqrt(np.diag(after))
        shared = np.abs(after / np.outer(spread, spread)) > SHARED
        return {name: tuple(names[j] for j in range(len(names)) if j != i and shared[i, j] and spread[j] > TOLD)
                for i, name in enumerate(names) if spread[i] > TOLD and name in group}


def _followed(q: np.ndarray, width: np.ndarray) -> np.ndarray:
    """(n, m) positions of links that follow motors at positions (n, m) through plays (m,), from the middle of them."""
    followed, half = q.copy(), 0.5 * width
    for k in range(1, len(q)):
        followed[k] = np.clip(followed[k - 1], q[k] - half, q[k] + half)
    return followed


def _rms(error: np.ndarray) -> float:
    """Root mean square distance of points, (f, n, 2) [px]."""
    return float(np.sqrt(np.mean(np.sum(error**2, axis=-1))))


def _motion(name: str) -> str:
    """The motion that tells a parameter of the images."""
    joint, _, key = name.rpartition(".")
    if "." + key == OFFSET:
        return (f"turn {joint} with other joints bent beyond it; the offset of a first joint is one with the place of "
                "the board, that of a last one with the camera's: measure it")
    if name == IMAGE_DELAY:
        return "move fast both ways with the board in view"
    if name in INTRINSICS:
        return "bring the board near and far, tilted, and into all corners of the image"
    if name == SIZE:
        return "move the camera along its axis and across, by more than the board's size"
    return "turn the camera about two axes with the board in view"
