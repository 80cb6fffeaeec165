"""What every calibration has in common: a name under which it is registered, its input, its result, and the check of
its residuals against the noise of the points."""

from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Dict, Optional, Protocol, Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError, Registry
from .boards import Board
from .camera_model import CameraCalibration

#: A residual above this many times what noise lets expect is not noise: the model or the samples are wrong.
MOST_TIMES = 1.5
#: Degrees of the polynomial that is smooth over a board, by the least number of its points.
DEGREES = ((40, 5), (30, 4), (20, 3), (12, 2))


@dataclass(frozen=True)
class Request:
    """What the user gives to a calibration. Options that it does not read are at their defaults.

    Attributes:
        board: of all images.  files: images, or lists of samples.  model: of the lens.  camera: file of the calibrated
        camera, "" without.  scenario: name or path, "" without.  link: that carries camera or board, "" without.
        z_star_m: depth of the target at the goal [m].
    """

    board: Board
    files: Tuple[str, ...]
    model: str = "plumb_bob"
    camera: str = ""
    scenario: str = ""
    link: str = ""
    z_star_m: float = 0.5

    def calibrated_camera(self) -> CameraCalibration:
        """Returns the camera of the file. Raises ParameterError: there is none."""
        if not self.camera:
            raise ParameterError("--camera: found nothing, allowed the file that `calibrate camera` wrote")
        with open(self.camera, encoding="utf-8") as stream:
            return CameraCalibration.from_yaml(stream.read(), self.camera)


@dataclass(frozen=True)
class Value:
    """One estimate: value and standard deviation (NaN: unknown) in a unit."""

    name: str
    value: float
    stddev: float
    unit: str


@dataclass(frozen=True)
class Calibrated:
    """Result of a calibration.

    Attributes:
        document: the file that it makes, or the part of a scenario.  values: its estimates.
        names: of the views used.  left_out: of images without a board.
        residual_px: root mean square of the distances between points seen and points projected.
        view_residuals_px: of each view.  parameters: how many numbers were fitted to these points.
        pixels: list of (n, 2), the points seen in each view.
        cost: what the errors cost at the goal, text -> value (one standard deviation).  cost_unit: of the values.
        unknown: (name, reason) of what these samples do not tell.  advice: what a large residual may come from.
    """

    document: Any
    values: Tuple[Value, ...]
    names: Tuple[str, ...]
    residual_px: float
    view_residuals_px: Tuple[float, ...]
    parameters: int
    pixels: Sequence[np.ndarray]
    cost: Dict[str, float] = field(default_factory=dict)
    cost_unit: str = ""
    unknown: Tuple[Tuple[str, str], ...] = ()
    advice: str = ""
    left_out: Tuple[str, ...] = ()


class Calibration(Protocol):
    """A calibration: registered by `@CALIBRATIONS.register(name, about=, files=)`.

    Attributes: about: what it finds, in one line.  files: what the files of a request are.
    """

    about: str
    files: str

    def __call__(self, request: Request) -> Calibrated:
        """Calibrates. Raises ParameterError: bad input, or samples with too little motion."""
        ...


CALIBRATIONS: "Registry[Calibration]" = Registry("calibration", __package__)


@dataclass(frozen=True)
class ResidualCheck:
    """Residual against what noise lets expect.

    Attributes:
        noise_px: standard deviation of a coordinate of a point, from each view alone, without any camera model; NaN
            with too few points.  expected_px: residual that this noise leaves after the fit.  times: residual over it.
    """

    noise_px: float
    expected_px: float
    times: float

    @property
    def fits(self) -> Optional[bool]:
        """Whether noise explains the residual; None if the noise is unknown."""
        return None if not np.isfinite(self.times) else self.times <= MOST_TIMES


def check_residuals(found: Calibrated, board: Board) -> ResidualCheck:
    """Returns the check of a result."""
    noise = point_noise_px(found.pixels, board)
    count = 2 * sum(map(len, found.pixels))
    expected = sqrt(2.0) * noise * sqrt(max(0.0, 1.0 - found.parameters / count))
    return ResidualCheck(noise, expected, found.residual_px / expected if expected > 0.0 else float("nan"))


def point_noise_px(views: Sequence[np.ndarray], board: Board) -> float:
    """Returns the standard deviation of a coordinate of the points [px], NaN with too few points on the board.

    A homography and a polynomial of the image plane follow every smooth lens; what they leave of a view is noise.

    Args: views: list of (n, 2) pixels, as `Board.find` gives them.
    """
    count = len(board.points_m)
    degree = next((degree for least, degree in DEGREES if count >= least), None)
    if degree is None or not len(views):
        return float("nan")
    return sqrt(float(np.mean([_noise_variance(np.asarray(view, dtype=float), board, degree) for view in views])))


def _noise_variance(view, board, degree):
    """Variance of a coordinate in one view [px^2].

    Of the homography only its last row matters: a polynomial of affinely changed coordinates is one of the same degree.
    """
    import cv2
    from scipy.optimize import least_squares
    plane = board.points_m[:, :2] - board.points_m[:, :2].mean(axis=0)
    plane = plane / np.abs(plane).max()
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]

    def left(tilt):
        """(2 n,) of the best polynomial for the last row (tilt, 1)."""
        x, y = (plane / (1.0 + plane @ tilt)[:, None]).T
        terms = np.column_stack([x**i * y**j for i, j in powers])
        return (view - terms @ np.linalg.lstsq(terms, view, rcond=None)[0]).ravel()
    H = cv2.findHomography(plane, view)[0]
    rest = least_squares(left, H[2, :2] / H[2, 2], method="lm").fun
    return float(rest @ rest) / (len(rest) - 2 * len(powers) - 2)
