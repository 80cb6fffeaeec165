"""Pixels of a detector as normalised coordinates, by the camera_info of its camera."""

from typing import Any, Dict, Optional, Sequence, Tuple

import numpy as np
from aras_visual_servo_camera import undistort

from aras_visual_servo import ArasError

from ..bags.bag import camera_info_of


class PixelCamera:
    """Camera model for `Source.read`.

    Attributes: frame_id: of camera_info, "" before it has come.
    """

    def __init__(self) -> None:
        self.frame_id, self._fault = "", "camera_info: none has come"
        self._info: Optional[Dict[str, Any]] = None

    def set_info(self, message: Any) -> None:
        """Takes a CameraInfo; one that no camera has leaves pixels without coordinates."""
        self.frame_id, self._info, self._fault = message.header.frame_id, None, ""
        try:
            self._info = camera_info_of(message)
            undistort(self._info, np.empty((0, 2)))
        except ArasError as error:
            self._fault = str(error)

    def normalised(self, pixels: Sequence[Tuple[float, float]]) -> Tuple[np.ndarray, str]:
        """Returns ((n, 2) x = X/Z and y = Y/Z without the lens distortion, reason of a failure or "")."""
        uv = np.array(pixels, dtype=float).reshape(-1, 2)
        if self._info is None or self._fault:
            return np.full(uv.shape, np.nan), self._fault
        xy = undistort(self._info, uv)
        outside = ~np.isfinite(xy).all(axis=1)
        if not outside.any():
            return xy, ""
        return xy, f"pixels: found {uv[outside].tolist()}, allowed pixels that the lens model maps to a ray"
