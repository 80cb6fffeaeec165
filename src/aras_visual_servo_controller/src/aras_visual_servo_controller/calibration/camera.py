"""Calibration of a camera from images of a board (OpenCV's calibrateCamera, after Zhang, IEEE T-PAMI 22(11), 2000)."""

from dataclasses import dataclass
from typing import Dict, Sequence, Tuple

import numpy as np
import yaml

from aras_visual_servo import ParameterError
from .boards import Board

#: Fewer views of a plane do not tell the intrinsics, or not well.
LEAST_VIEWS = 5


@dataclass(frozen=True)
class CameraCalibration:
    """Intrinsics of a camera with a plumb_bob lens.

    Read from a file that says nothing of its residual, residual_px and stddev are NaN.

    Attributes:
        width, height: [px].  K: (3, 3).  distortion: (5,) k1 k2 p1 p2 k3.
        residual_px: root mean square of the distances between points seen and points projected.
        view_residuals_px: of each view.  stddev: (9,) standard deviations of fx, fy, cx, cy [px] and the
        distortion, from the residual.
    """

    width: int
    height: int
    K: np.ndarray
    distortion: np.ndarray
    residual_px: float
    view_residuals_px: Tuple[float, ...]
    stddev: np.ndarray

    @property
    def intrinsics(self) -> np.ndarray:
        """(9,) fx, fy, cx, cy [px], k1, k2, p1, p2, k3."""
        return np.concatenate([self.K[[0, 1, 0, 1], [0, 1, 2, 2]], self.distortion])

    def as_yaml(self, name: str = "camera") -> str:
        """Text of a file as drivers read it through camera_info_url; they leave `calibration` out."""
        def matrix(rows, columns, data):
            return {"rows": rows, "cols": columns, "data": [float(value) for value in np.ravel(data)]}
        P = np.column_stack([self.K, np.zeros(3)])
        return yaml.safe_dump({
            "image_width": self.width, "image_height": self.height, "camera_name": name,
            "camera_matrix": matrix(3, 3, self.K), "distortion_model": "plumb_bob",
            "distortion_coefficients": matrix(1, 5, self.distortion),
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
            stddev = np.array(made.get("stddev", [float("nan")] * 9), dtype=float).reshape(9)
        except (yaml.YAMLError, AttributeError, KeyError, TypeError, ValueError) as error:
            raise ParameterError(f"{source}: found no calibration of a camera ({error}), allowed a file of "
                                 "`calibrate camera` or of camera_info_url") from error
        if model != "plumb_bob" or distortion.shape != (5,):
            raise ParameterError(f"{source}: found {model} with {distortion.size} coefficients, allowed plumb_bob with "
                                 "5")
        return cls(*size, K, distortion, residual_px, (), stddev)

    def cost(self, z_star_m: float) -> Dict[str, float]:
        """What the error of the intrinsics costs at the goal, dict of texts -> mm (one standard deviation).

        A taught goal is an image: at the goal the same camera sees the same picture, whatever its intrinsics are taken
        for. A goal given in numbers (a pose from a model of the target) is wrong by what this says.
        """
        (fx, fy), (s_fx, s_fy, s_cx, s_cy) = np.diag(self.K)[:2], self.stddev[:4]
        return {"taught goal": 0.0, "goal in numbers, x": 1e3 * z_star_m * s_cx / fx,
                "goal in numbers, y": 1e3 * z_star_m * s_cy / fy,
                "goal in numbers, depth": 1e3 * z_star_m * 0.5 * (s_fx / fx + s_fy / fy)}


def calibrate_camera(views: Sequence[np.ndarray], board: Board, size: Tuple[int, int]) -> CameraCalibration:
    """`CameraCalibration` from views of a board.

    Args: views: list of (n, 2) pixels, as `Board.find` gives them.  size: (width, height) of the images [px].
    Raises: ParameterError: too few views.
    """
    import cv2
    if len(views) < LEAST_VIEWS:
        raise ParameterError(f"views of the board: found {len(views)}, allowed >= {LEAST_VIEWS}, tilted differently")
    points = [board.points_m.astype(np.float32)] * len(views)
    pixels = [np.asarray(view, dtype=np.float32).reshape(-1, 1, 2) for view in views]
    rms, K, distortion, _, _, stddev, _, each = cv2.calibrateCameraExtended(points, pixels, tuple(size), None, None)
    return CameraCalibration(int(size[0]), int(size[1]), K, distortion.ravel()[:5], float(rms),
                             tuple(np.ravel(each).tolist()), np.ravel(stddev)[:9])
