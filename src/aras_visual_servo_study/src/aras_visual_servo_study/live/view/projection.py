"""Where things are in an image, and where an observer stands beside the arm."""

import math
from typing import Any, Dict, Tuple

import numpy as np

from aras_visual_servo import ParameterError

AZIMUTH, ELEVATION = math.radians(-45.0), math.radians(11.0)   # direction from the target to the observer
# The picture shows this much of the arm above the camera, as a multiple of the height of the camera over the target.
REACH = 1.4
MARGIN = 1.75    # distance of the observer, as a multiple of the height of what it looks at


def middle(path: np.ndarray) -> np.ndarray:
    """Mean of the points (n, 3) that are known [m], a metre above the origin where none is.

    A pose read from a bag was a quaternion and differs in its last digits. Rounded, it gives the same picture.
    """
    known = path[np.isfinite(path).all(axis=1)]
    return np.round(known.mean(axis=0), 4) if len(known) else np.array([0.0, 0.0, 1.0])


def standpoint(at_C: np.ndarray, at_T: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """(eye, look_at), (3,) each, world [m]: far enough to see from the target up to the arm above the camera."""
    height = max(abs(at_C[2] - at_T[2]) * (1.0 + REACH), 0.5)
    look_at = np.array([(at_C[0] + at_T[0]) / 2, (at_C[1] + at_T[1]) / 2, min(at_C[2], at_T[2]) + 0.47 * height])
    away = np.array([math.cos(ELEVATION) * math.cos(AZIMUTH), math.cos(ELEVATION) * math.sin(AZIMUTH),
                     math.sin(ELEVATION)])
    return look_at + MARGIN * height * away, look_at


def project(xy: np.ndarray, camera_info: Dict[str, Any]) -> np.ndarray:
    """Pixels (n, 2) of normalised image coordinates (n, 2) of a camera, of any distortion model; NaN stays NaN.

    Args: camera_info: dict as `Simulation.camera_info`.  Raises: ParameterError: there is none.
    """
    if not camera_info:
        raise ParameterError("the record has no camera_info (record the group features)")
    K = np.array(camera_info["K"], dtype=float).reshape(3, 3)
    D = np.array(camera_info.get("D") or [], dtype=float)
    pixels = np.full((len(xy), 2), np.nan)
    seen = np.all(np.isfinite(xy), axis=1)
    if not seen.any():
        return pixels
    if not D.any() and camera_info.get("distortion_model") != "equidistant":
        pixels[seen] = xy[seen] * K[[0, 1], [0, 1]] + K[:2, 2]
        return pixels
    import cv2  # only for a lens: it is slow to import
    points = np.column_stack([xy[seen], np.ones(seen.sum())])
    zero = np.zeros(3)
    if camera_info.get("distortion_model") == "equidistant":
        pixels[seen] = cv2.fisheye.projectPoints(points[:, None], zero, zero, K, D[:4])[0].reshape(-1, 2)
    else:
        pixels[seen] = cv2.projectPoints(points, zero, zero, K, D if len(D) else None)[0].reshape(-1, 2)
    return pixels
