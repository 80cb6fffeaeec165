"""Where the camera is on the arm, from views of a board that rests while the arm moves.

A first guess solves A X = X B (OpenCV's calibrateHandEye, after Park and Martin, IEEE T-RA 10(5), 1994). Then the
pixels of all views are fitted at once. Unknown are the pose of the camera on its link, X_FC, that of the board in the
base, X_BO, and the camera's intrinsics within what their own calibration leaves open: an error of the focal length
looks like a camera that sits elsewhere. The fit also tells how well X_FC is known.
"""

from dataclasses import dataclass
from math import hypot
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError
from aras_visual_servo.spatial import exponential, inverse, rotation_vector, rpy_of, transform
from .boards import Board
from .camera_model import CameraCalibration
from .family import CALIBRATIONS, Calibrated, Request, Value
from .samples import FILES, ArmSamples

LEAST_VIEWS = 4
#: The arm must turn about axes that differ, or the translation along the one axis stays unknown [rad].
LEAST_TURN_RAD = 0.1
#: What a residual comes from that noise does not explain.
ADVICE = ("joint offsets (`calibrate joint_offsets`), a board that is not flat, images taken in motion, or another "
          "camera file")
#: Triples of samples that are tried where a residual is too large.
TRIALS = 60


@dataclass(frozen=True)
class HandEye:
    """Attributes:
        X_FC: (4, 4) camera in the frame of its link.  X_BO: (4, 4) board in the base.
        residual_px: root mean square over all points.  view_residuals_px: of each view.
        stddev_m, stddev_rad: of position and attitude of X_FC, from the residual: of their worst directions.
    """

    X_FC: np.ndarray
    X_BO: np.ndarray
    residual_px: float
    view_residuals_px: Tuple[float, ...]
    stddev_m: float
    stddev_rad: float

    @property
    def rpy_rad(self) -> Tuple[float, float, float]:
        """Roll, pitch and yaw of X_FC, as `robot.hand_eye` has them."""
        return rpy_of(self.X_FC[:3, :3])

    def cost(self, z_star_m: float) -> Dict[str, float]:
        """What the error costs at the goal, dict of texts -> mm (one standard deviation).

        A taught goal is the same posture before the same picture. A goal given as a pose of the camera in the base is
        off by the error itself, and what the camera then sees at the depth of the target by its turn as well.
        """
        return {"taught goal": 0.0, "goal as a camera pose": 1e3 * self.stddev_m,
                "goal as a camera pose, at the target": 1e3 * hypot(self.stddev_m, z_star_m * self.stddev_rad)}


@CALIBRATIONS.register("hand_eye", about="where the camera is on its link, for robot.hand_eye",
                       files=FILES)
def hand_eye(request: Request) -> Calibrated:
    """The calibration `hand_eye`."""
    samples, camera = ArmSamples(request), request.calibrated_camera()
    found = calibrate_hand_eye(samples.poses, samples.views, request.board, camera, samples.names)
    return hand_eye_result(found, samples, camera, request, {"hand_eye": hand_eye_section(found, request.link)})


def hand_eye_section(found: HandEye, link: str) -> Dict[str, Any]:
    """Returns the section `robot.hand_eye`."""
    return {"link": link, "position_m": [float(round(value, 6)) for value in found.X_FC[:3, 3]],
            "rpy_rad": [float(round(value, 6)) for value in found.rpy_rad]}


def hand_eye_result(found: HandEye, samples: ArmSamples, camera: CameraCalibration, request: Request,
                    robot: Dict[str, Any], more: Sequence[Value] = (), unknown: Tuple[Tuple[str, str], ...] = (),
                    advice: str = ADVICE) -> Calibrated:
    """Returns the result of a hand-eye calibration. Args: robot: its part of the section `robot`.  more: values beside
    those of the camera's place.  unknown, advice: of the result."""
    values = [*(Value(name, float(value), found.stddev_m, "m") for name, value in zip("xyz", found.X_FC[:3, 3])),
              *(Value(name, float(value), found.stddev_rad, "rad")
                for name, value in zip(("roll", "pitch", "yaw"), found.rpy_rad)), *more]
    return Calibrated({"robot": robot}, tuple(values), samples.names, found.residual_px, found.view_residuals_px,
                      12 + len(more), samples.views, found.cost(request.z_star_m), f"mm, at {request.z_star_m:g} m",
                      unknown, advice, samples.left_out)


def calibrate_hand_eye(poses: Sequence[np.ndarray], views: Sequence[np.ndarray], board: Board,
                       camera: CameraCalibration, names: Optional[Sequence[str]] = None) -> HandEye:
    """Returns where the camera is on a link of the arm. The board rests.

    A camera that stands still and sees a board on a link of the arm is the same problem: with the inverse poses X_FB,
    the result's X_FC is the camera in the base, and its X_BO the board on the link.

    Args:
        poses: list of X_BF, (4, 4), of the link that carries the camera.  views: list of (n, 2) pixels of the board.
        names: of the samples, for errors; None: their numbers.
    Raises: ParameterError: too few views, an arm that did not turn about two axes, or samples whose poses do not belong
        to their views.
    """
    if len(views) < LEAST_VIEWS or len(views) != len(poses):
        raise ParameterError(f"views of the board: found {len(views)} with {len(poses)} poses of the arm, allowed >= "
                             f"{LEAST_VIEWS}, one pose each")
    check_turns(poses)
    boards = [camera.pose_of(view, board) for view in views]
    found = _fitted(poses, views, board, camera, *first_guess(poses, boards))
    if not max(found.view_residuals_px) < camera.residual_limit_px:
        names = [str(k) for k in range(len(views))] if names is None else names
        raise ParameterError(
            f"samples: found a residual of {max(found.view_residuals_px):.3g} px in the worst, allowed below "
            f"{camera.residual_limit_px:.3g}; "
            + _suspects(poses, boards, views, board, camera, names))
    return found


def first_guess(poses: Sequence[np.ndarray], boards: Sequence[np.ndarray]) -> Tuple[np.ndarray, np.ndarray]:
    """Returns (X_FC, X_BO) of poses X_BF and X_CO. Raises cv2.error where the poses do not tell."""
    import cv2
    R, t = cv2.calibrateHandEye([X[:3, :3] for X in poses], [X[:3, 3] for X in poses], [X[:3, :3] for X in boards],
                                [X[:3, 3] for X in boards], method=cv2.CALIB_HAND_EYE_PARK)
    X_FC = transform(R, t.ravel())
    return X_FC, poses[0] @ X_FC @ boards[0]


def _suspects(poses, boards, views, board, camera, names):
    """Says which samples do not fit the others, or by how many places poses and views are out of step."""
    count = len(views)
    fitting = _consensus(poses, boards, views, board, camera)
    if count > len(fitting) > count / 2:
        others = ", ".join(names[k] for k in range(count) if k not in fitting)
        return f"without {others} the others fit: take these samples again"
    if len(fitting) == count:
        return "all samples fit one place of the camera, but not well: check the size of the board and the arm's model"
    for lag in (1, -1, 2, -2):
        late, early = slice(max(0, lag), count + min(0, lag)), slice(max(0, -lag), count - max(0, lag))
        fitting = _consensus(poses[early], boards[late], views[late], board, camera)
        if 2 * len(fitting) > count:
            return (f"the joints of a sample fit the image {abs(lag)} {'after' if lag > 0 else 'before'} it: "
                    "joints and images are out of step")
    return "no half of the samples fits together: check joints (radians, signs), --link, and the size of the board"


def _consensus(poses, boards, views, board, camera):
    """Indices of the most samples that one place of the camera explains (RANSAC over triples; Fischler 1981)."""
    import cv2
    random, best = np.random.default_rng(0), []
    for _ in range(TRIALS if len(views) >= LEAST_VIEWS else 0):
        chosen = random.choice(len(views), 3, replace=False)
        try:
            X_FC, X_BO = first_guess([poses[k] for k in chosen], [boards[k] for k in chosen])
        except cv2.error:
            continue
        if not np.isfinite(X_BO).all():
            continue
        off = [camera.project(board.points_m, inverse(X_BF @ X_FC) @ X_BO) - view for X_BF, view in zip(poses, views)]
        near = [k for k, each in enumerate(off)
                if np.sqrt((each**2).sum(axis=1).mean()) < 2.0 * camera.residual_limit_px]
        best = max(best, near, key=len)
    return best


def _fitted(poses, views, board, camera, X_FC, X_BO):
    return fit_chain(lambda _: poses, np.zeros(0), views, board, camera, X_FC, X_BO).hand_eye


class ChainFit(NamedTuple):
    """hand_eye: `HandEye`.  more, more_stddev: (m,), the other unknowns of the chain."""

    hand_eye: HandEye
    more: np.ndarray
    more_stddev: np.ndarray


def fit_chain(poses_of: Callable[[np.ndarray], List[np.ndarray]], prior: np.ndarray, views: Sequence[np.ndarray],
              board: Board, camera: CameraCalibration, X_FC: np.ndarray, X_BO: np.ndarray) -> ChainFit:
    """Fits the pixels of all views at once: X_FC, X_BO, the intrinsics within their deviations, and m more unknowns.

    Args:
        poses_of: poses X_BF of the link for values (m,) of these.  prior: (m,) their standard deviations before the
            fit, about zero.  X_FC, X_BO: first guesses.
    """
    from scipy.optimize import least_squares
    taken, count = camera.intrinsics, len(prior)
    free = bool(np.isfinite(camera.stddev).all() and (camera.stddev > 0.0).all())
    pixel = camera.residual_px / np.sqrt(2.0) if camera.residual_px > 0.0 else 1.0  # of one coordinate

    def residuals(step):
        at, to = X_FC @ exponential(step[:6]), X_BO @ exponential(step[6:12])
        intrinsics = taken + camera.stddev * step[12 + count:] if free else taken
        left = [(camera.project(board.points_m, inverse(X_BF @ at) @ to, intrinsics) - view).ravel() / pixel
                for X_BF, view in zip(poses_of(prior * step[12:12 + count]), views)]
        return np.concatenate([*left, step[12:]])

    found = least_squares(residuals, np.zeros(12 + count + len(taken) * free), x_scale="jac", method="lm")
    left = pixel * found.fun[:2 * sum(map(len, views))].reshape(len(views), -1)
    variance = max(1.0 if free else 0.0, float(found.fun @ found.fun) / max(1, left.size - 12 - count))
    covariance = variance * np.linalg.pinv(found.jac.T @ found.jac)
    worst = [float(np.sqrt(np.linalg.eigvalsh(covariance[k:k + 3, k:k + 3])[-1])) for k in (0, 3)]
    rms = [float(np.sqrt(2.0 * np.mean(each**2))) for each in left]
    return ChainFit(HandEye(X_FC @ exponential(found.x[:6]), X_BO @ exponential(found.x[6:12]),
                            float(np.sqrt(2.0 * np.mean(left**2))), tuple(rms), *worst),
                    prior * found.x[12:12 + count], prior * np.sqrt(np.diag(covariance)[12:12 + count]))


def check_turns(poses: Sequence[np.ndarray]) -> None:
    """Raises ParameterError unless the arm turned about axes that differ."""
    turns = np.array([rotation_vector(poses[0][:3, :3].T @ X[:3, :3]) for X in poses[1:]])
    second = float(np.linalg.svd(turns, compute_uv=False)[1])
    if second < LEAST_TURN_RAD:
        raise ParameterError(f"poses of the arm: found turns about one axis (about others {second:.3f} rad), allowed "
                             f"turns about two axes by {LEAST_TURN_RAD:g} rad or more")
