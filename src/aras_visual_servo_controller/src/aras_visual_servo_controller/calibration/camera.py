"""Calibrates a camera from images of a board (OpenCV's calibrateCamera, after Zhang, IEEE T-PAMI 22(11), 2000).

Fisheye lenses have the model `equidistant` (Kannala and Brandt, IEEE T-PAMI 28(8), 2006): OpenCV's module fisheye.
"""

from typing import Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError
from .boards import Board
from .camera_model import MODELS, CameraCalibration
from .family import CALIBRATIONS, Calibrated, Request, Value
from .samples import found_views, image_of_file

#: Fewer views of a plane do not tell the intrinsics, or not well.
LEAST_VIEWS = 5
#: The board must be tilted by this between two of the views.
LEAST_TILT_DEG = 10.0
#: Largest standard deviation of a focal length, as a part of it.
MOST_SPREAD = 0.02
NAMES = ("fx", "fy", "cx", "cy")
DISTORTION = {"equidistant": ("k1", "k2", "k3", "k4")}
BROWN = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


@CALIBRATIONS.register("camera", about="the intrinsics, as camera_info_url reads them", files="images of the board")
def camera(request: Request) -> Calibrated:
    """The calibration `camera`."""
    images = [image_of_file(path) for path in request.files]
    sizes = {image.shape[1::-1] for image in images}
    if len(sizes) != 1:
        raise ParameterError(f"images: found sizes {sorted(sizes)}, allowed one size")
    names, views, left_out = found_views(request.files, images, request.board)
    found = calibrate_camera(views, request.board, sizes.pop(), request.model)
    lens = DISTORTION.get(request.model, BROWN[:MODELS[request.model]])
    values = tuple(Value(name, float(value), float(stddev), "px" if name in NAMES else "1")
                   for name, value, stddev in zip((*NAMES, *lens), found.intrinsics, found.stddev))
    return Calibrated(found.as_yaml(), values, names, found.residual_px, found.view_residuals_px,
                      len(found.intrinsics) + 6 * len(views), views, found.cost(request.z_star_m),
                      f"mm, at {request.z_star_m:g} m", left_out=left_out,
                      advice="another lens (--model), a board that is not flat, or a shutter that moved")


def calibrate_camera(views: Sequence[np.ndarray], board: Board, size: Tuple[int, int],
                     model: str = "plumb_bob") -> CameraCalibration:
    """Returns the calibration from views of a board.

    Args:
        views: list of (n, 2) pixels, as `Board.find` gives them.  size: (width, height) of the images [px].
        model: of the lens, a key of MODELS.
    Raises: ParameterError: too few views, an unknown model, or views that do not tell the intrinsics, because the board
        was hardly tilted.
    """
    if len(views) < LEAST_VIEWS:
        raise ParameterError(f"views of the board: found {len(views)}, allowed >= {LEAST_VIEWS}, tilted differently")
    if model not in MODELS:
        raise ParameterError(f"model: found {model}, allowed {' | '.join(MODELS)}")
    width, height = map(int, size)
    found = (_fisheye(views, board, width, height) if model == "equidistant"
             else _pinhole(views, board, width, height, model))
    normals = np.array([found.pose_of(view, board)[:3, 2] for view in views])
    tilt = float(np.degrees(np.arccos(np.clip(normals @ normals.T, -1.0, 1.0)).max()))
    if not tilt > LEAST_TILT_DEG:
        raise ParameterError(f"views of the board: found tilts by {tilt:.1f} deg from each other, allowed one of "
                             f"{LEAST_TILT_DEG:g} deg or more: tilt the board more, about both axes")
    spread = float((found.stddev[:2] / np.diag(found.K)[:2]).max())
    if not spread < MOST_SPREAD:
        raise ParameterError(f"views of the board: found a focal length known to {100 * spread:.2g} % only, allowed "
                             f"{100 * MOST_SPREAD:g} %: tilt the board more, about both axes, and bring it nearer")
    return found


def _pinhole(views, board, width, height, model):
    import cv2
    points = [board.points_m.astype(np.float32)] * len(views)
    pixels = [np.asarray(view, dtype=np.float32).reshape(-1, 1, 2) for view in views]
    flags = cv2.CALIB_RATIONAL_MODEL if model == "rational_polynomial" else 0
    rms, K, distortion, _, _, stddev, _, each = cv2.calibrateCameraExtended(points, pixels, (width, height), None, None,
                                                                            flags=flags)
    count = MODELS[model]
    return CameraCalibration(width, height, K, distortion.ravel()[:count], float(rms), tuple(np.ravel(each).tolist()),
                             np.ravel(stddev)[:4 + count], model)


def _fisheye(views, board, width, height):
    import cv2
    pixels = [np.asarray(view, dtype=float).reshape(1, -1, 2) for view in views]
    points = [board.points_m[None]] * len(views)
    try:
        _, K, distortion, turns, places = cv2.fisheye.calibrate(
            points, pixels, (width, height), None, None,
            flags=cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_FIX_SKEW)
    except cv2.error as error:
        raise ParameterError("views of the board: found views that do not tell the intrinsics of a fisheye lens, "
                             f"allowed tilted ones, up to the border of the image ({error.err})") from error
    # Gauss-Newton's normal matrix of the intrinsics, after the pose of each view has been eliminated.
    normal, each = np.zeros((8, 8)), []
    for view, turn, place in zip(pixels, turns, places):
        seen, J = cv2.fisheye.projectPoints(board.points_m[None], turn, place, K, distortion, jacobian=None)
        of_camera, of_pose = J[:, :8], J[:, 8:14]
        normal += of_camera.T @ (of_camera - of_pose @ np.linalg.lstsq(of_pose, of_camera, rcond=None)[0])
        each.append(float(np.sqrt(np.mean(((seen - view)[0]**2).sum(axis=1)))))
    rms = float(np.sqrt(np.mean(np.square(each))))
    samples = 2 * len(views) * len(board.points_m)
    variance = 0.5 * rms**2 * samples / max(1, samples - 8 - 6 * len(views))
    stddev = np.sqrt(variance * np.diag(np.linalg.pinv(normal)))
    return CameraCalibration(width, height, K, distortion.ravel(), rms, tuple(each), stddev, "equidistant")
