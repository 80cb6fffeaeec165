"""Intrinsics of a calibrated camera: projection, file, and what their errors cost."""

from dataclasses import dataclass
from typing import Dict, Optional, Tuple

import numpy as np
import yaml

from aras_visual_servo import ParameterError
from aras_visual_servo.spatial import exponential, transform
from .boards import Board

#: Lens models, with the number of their coefficients.
MODELS = {"plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}
#: A residual above FAR times that of the camera's own calibration, and above FAR_PX, comes from wrong input.
FAR, FAR_PX = 10.0, 3.0


@dataclass(frozen=True)
class CameraCalibration:
    """Intrinsics of a camera.

    Read from a file that says nothing of its residual, residual_px and stddev are NaN.

    Attributes:
        width, height: [px].  K: (3, 3).  distortion: of a plumb_bob lens (5,) k1 k2 p1 p2 k3, of a
        rational_polynomial one (8,) with k4 k5 k6, of an equidistant one (4,) k1 to k4.
        residual_px: root mean square of the distances between points seen and points projected.
        view_residuals_px: of each view.  stddev: standard deviations of the `intrinsics`, from the
        residual.
    """

    width: int
    height: int
    K: np.ndarray
    distortion: np.ndarray
    residual_px: float
    view_residuals_px: Tuple[float, ...]
    stddev: np.ndarray
    distortion_model: str = "plumb_bob"

    @property
    def intrinsics(self) -> np.ndarray:
        """fx, fy, cx, cy [px], and the distortion: (9,), (12,) or (8,)."""
        return np.concatenate([self.K[[0, 1, 0, 1], [0, 1, 2, 2]], self.distortion])

    @property
    def residual_limit_px(self) -> float:
        """Residual above which poses, images and board cannot belong together [px]."""
        return max(FAR * self.residual_px, FAR_PX) if np.isfinite(self.residual_px) else FAR_PX

    def project(self, points_m: np.ndarray, X_CO: np.ndarray, intrinsics: Optional[np.ndarray] = None) -> np.ndarray:
        """Returns pixels, (n, 2). Args: points_m: (n, 3) in O. intrinsics: in place of the camera's own."""
        import cv2
        fx, fy, cx, cy, *distortion = self.intrinsics if intrinsics is None else intrinsics
        K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        turn, _ = cv2.Rodrigues(np.ascontiguousarray(X_CO[:3, :3]))
        if self.distortion_model == "equidistant":
            place = np.ascontiguousarray(X_CO[:3, 3]).reshape(3, 1)
            return cv2.fisheye.projectPoints(points_m[:, None], turn, place, K, np.array(distortion))[0].reshape(-1, 2)
        return cv2.projectPoints(points_m, turn, X_CO[:3, 3], K, np.array(distortion))[0].reshape(-1, 2)

    def pose_of(self, view: np.ndarray, board: Board) -> np.ndarray:
        """Returns X_CO, (4, 4), of a board from its pixels (n, 2)."""
        import cv2
        from scipy.optimize import least_squares
        view, K, distortion = np.asarray(view, dtype=float), self.K, self.distortion
        seen = view
        if self.distortion_model == "equidistant":
            seen = cv2.fisheye.undistortPoints(view[:, None], K, distortion)[:, 0]
            K, distortion = np.eye(3), np.zeros(5)
        _, turn, place = cv2.solvePnP(board.points_m, seen, K, distortion)
        X_CO = transform(cv2.Rodrigues(turn)[0], place.ravel())
        if self.distortion_model != "equidistant":
            return X_CO  # solvePnP has fitted the pixels
        found = least_squares(lambda step: (self.project(board.points_m, X_CO @ exponential(step)) - view).ravel(),
                              np.zeros(6), x_scale="jac", method="lm")
        return X_CO @ exponential(found.x)

    def as_yaml(self, name: str = "camera") -> str:
        """Text of a file as drivers read it through camera_info_url; they leave `calibration` out."""
        def matrix(rows, columns, data):
            return {"rows": rows, "cols": columns, "data": [float(value) for value in np.ravel(data)]}
        P = np.column_stack([self.K, np.zeros(3)])
        return yaml.safe_dump({
            "image_width": self.width, "image_height": self.height, "camera_name": name,
            "camera_matrix": matrix(3, 3, self.K), "distortion_model": self.distortion_model,
            "distortion_coefficients": matrix(1, len(self.distortion), self.distortion),
            "rectification_matrix": matrix(3, 3, np.eye(3)), "projection_matrix": matrix(3, 4, P),
            "calibration": {"residual_px": self.residual_px, "stddev": [float(each) for each in self.stddev]},
        }, sort_keys=False)

    @classmethod
    def from_yaml(cls, text: str, source: str = "camera") -> "CameraCalibration":
        """Read what `as_yaml`, or ROS's camera_calibration, wrote. Raises ParameterError."""
        try:
            content = yaml.safe_load(text)
            K = np.array(content["camera_matrix"]["data"], dtype=float).reshape(3, 3)
            distortion = np.array(content["distortion_coefficients"]["data"], dtype=float)
            size = int(content["image_width"]), int(content["image_height"])
            model, made = content["distortion_model"], content.get("calibration", {})
            residual_px = float(made.get("residual_px", "nan"))
            count = 4 + distortion.size
            stddev = np.array(made.get("stddev", [float("nan")] * count), dtype=float).reshape(count)
        except (yaml.YAMLError, AttributeError, KeyError, TypeError, ValueError) as error:
            raise ParameterError(f"{source}: found no calibration of a camera ({error}), allowed a file of "
                                 "`calibrate camera` or of camera_info_url") from error
        if MODELS.get(model) != distortion.size:
            raise ParameterError(f"{source}: distortion_model: found {model} with {distortion.size} coefficients, "
                                 "allowed " + ", ".join(f"{name} with {count}" for name, count in MODELS.items()))
        return cls(*size, K, distortion, residual_px, (), stddev, model)

    def cost(self, z_star_m: float) -> Dict[str, float]:
        """What the error of the intrinsics costs at the goal, dict of texts -> mm (one standard deviation).

        A taught goal is an image: at the goal the same camera sees the same picture, whatever its intrinsics are taken
        for. A goal given in numbers (a pose from a model of the target) is wrong by what this says.
        """
        (fx, fy), (s_fx, s_fy, s_cx, s_cy) = np.diag(self.K)[:2], self.stddev[:4]
        return {"taught goal": 0.0, "goal in numbers, x": 1e3 * z_star_m * s_cx / fx,
                "goal in numbers, y": 1e3 * z_star_m * s_cy / fy,
                "goal in numbers, depth": 1e3 * z_star_m * 0.5 * (s_fx / fx + s_fy / fy)}
