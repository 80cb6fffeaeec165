"""Where the target is in the camera's frame: depth and normal of its plane, from a board that lies on it."""

from dataclasses import dataclass
from typing import Dict

import numpy as np

from aras_visual_servo import ParameterError
from aras_visual_servo.spatial import exponential
from .boards import Board
from .camera_model import CameraCalibration
from .family import CALIBRATIONS, Calibrated, Request, Value
from .samples import found_views, image_of_file

#: Largest standard deviations of the depth, as a part of it, and of the normal [rad].
MOST_SPREAD, MOST_TILT_RAD = 0.02, 0.05


@dataclass(frozen=True)
class TargetPlane:
    """Attributes:
        X_CO: (4, 4) board in the camera's frame.  z_star_m: depth of its plane on the optical axis [m].
        normal_C: (3,) of the plane, away from the camera.  residual_px: root mean square over its points.
        stddev_z_m, stddev_tilt_rad: of depth and normal, from the residual and from what the camera's calibration
        leaves open.
    """

    X_CO: np.ndarray
    z_star_m: float
    normal_C: np.ndarray
    residual_px: float
    stddev_z_m: float
    stddev_tilt_rad: float

    def cost(self) -> Dict[str, float]:
        """What the error costs at the goal, dict of texts -> value (one standard deviation).

        A taught goal stays where it was taught: a wrong depth scales s and s* alike. Gains are wrong by its part. A
        goal given in numbers is off by the error.
        """
        return {"taught goal, mm": 0.0, "gain of the translation, %": 1e2 * self.stddev_z_m / self.z_star_m,
                "goal in numbers, depth, mm": 1e3 * self.stddev_z_m,
                "goal in numbers, tilt, mm at the target": 1e3 * self.z_star_m * self.stddev_tilt_rad}


@CALIBRATIONS.register("target", about="depth and normal of the plane that the board is on, for experiment.z_star_m "
                       "and servo.target_normal_C", files="one image, at the goal")
def target(request: Request) -> Calibrated:
    """The calibration `target`."""
    if len(request.files) != 1:
        raise ParameterError(f"target: found {len(request.files)} images, allowed one, at the goal")
    names, views, _ = found_views(request.files, [image_of_file(path) for path in request.files], request.board)
    found = target_plane(views[0], request.board, request.calibrated_camera())
    values = (Value("depth", found.z_star_m, found.stddev_z_m, "m"),
              *(Value(f"normal {axis}", float(value), found.stddev_tilt_rad, "1")
                for axis, value in zip("xyz", found.normal_C)))
    document = {"servo": {"target_normal_C": [float(round(value, 6)) for value in found.normal_C]},
                "experiment": {"z_star_m": float(round(found.z_star_m, 6))}}
    return Calibrated(document, values, names, found.residual_px, (found.residual_px,), 6, views, found.cost(),
                      advice="a board that is not flat, or another camera file")


def target_plane(view: np.ndarray, board: Board, camera: CameraCalibration) -> TargetPlane:
    """`TargetPlane` of a board in a view. Args: view: (n, 2) pixels.  camera: `CameraCalibration`.

    Raises ParameterError: the board is seen from its edge, so that the optical axis does not meet its plane in front;
    the residual is far above the camera's own; or depth and normal are hardly known.
    """
    X_CO, view = camera.pose_of(view, board), np.asarray(view, dtype=float)
    jacobian = np.column_stack([_derivative(X_CO, k, board, camera) for k in range(6)])
    left = camera.project(board.points_m, X_CO) - view
    residual_px = float(np.sqrt(2.0 * np.mean(left**2)))
    if not residual_px < camera.residual_limit_px:
        raise ParameterError(f"board: found a residual of {residual_px:.3g} px, allowed below "
                             f"{camera.residual_limit_px:.3g}: are --columns, --rows and --camera those of this image?")
    variance = float((left**2).sum()) / max(1, left.size - 6)
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    normal, depth_m = _plane(X_CO)
    if not depth_m > 0.0:
        raise ParameterError(f"board: its plane meets the optical axis at {depth_m:.3f} m, allowed > 0")
    slope = np.array([(_plane(X_CO @ exponential(step))[1] - depth_m) / 1e-6 for step in 1e-6 * np.eye(6)])
    tilt = float(np.sqrt(np.linalg.eigvalsh(covariance[3:5, 3:5])[-1]))
    of_focal_length = np.nan_to_num(depth_m * 0.5 * (camera.stddev[:2] / np.diag(camera.K)[:2]).sum())
    stddev_m = float(np.hypot(np.sqrt(slope @ covariance @ slope), of_focal_length))
    if not (stddev_m < MOST_SPREAD * depth_m and tilt < MOST_TILT_RAD):
        raise ParameterError(f"board: found its depth known to {1e2 * stddev_m / depth_m:.2g} % and its normal to "
                             f"{np.degrees(tilt):.2g} deg, allowed {1e2 * MOST_SPREAD:g} % and "
                             f"{np.degrees(MOST_TILT_RAD):.2g} deg: take a larger board, or look from nearer")
    return TargetPlane(X_CO, depth_m, normal, residual_px, stddev_m, tilt)


def _plane(X_CO):
    """((3,) normal away from the camera, depth of the plane on the optical axis [m])."""
    normal = X_CO[:3, 2] * np.sign(X_CO[:3, 2] @ X_CO[:3, 3])
    return normal, float(normal @ X_CO[:3, 3] / normal[2])


def _derivative(X_CO, k, board, camera, h=1e-6):
    step = np.zeros(6)
    step[k] = h
    ahead, behind = (camera.project(board.points_m, X_CO @ exponential(sign * step)) for sign in (1.0, -1.0))
    return ((ahead - behind) / (2.0 * h)).ravel()
