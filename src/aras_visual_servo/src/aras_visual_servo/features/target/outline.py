"""Where a scenario's target lies in the image, computed from poses alone. This tells before a run whether the target
will be in view, and after a run how near it came to the image border. It works for flat targets of known outline, with
pinhole cameras and plumb_bob lenses. No ROS."""

import functools
from math import inf, tan

import numpy as np

from ...ground.errors import ParameterError
from ...spatial import inverse, pose_from_rpy
from ...config.files import load_yaml, resolve_uri


class Outline:
    """Outline of the first model of a scene and the camera that looks at it.

    Attributes:
        X_WT: (4, 4) pose of the target in the world, as the scenario places it; of a target that a link carries, in the
            frame of this link, as the poses of `EyeToHand`.  points_T: (n, 3), z = 0 [m].
        half: (x, y): half of the image in normalised coordinates, for a camera without a lens.
    """

    def __init__(self, outlines_m, X_WT, camera):
        """Args: outlines_m: polygons (n, 2) [m]. X_WT: (4, 4). camera: dict of section sim.cameras."""
        corners = np.concatenate([np.asarray(outline, dtype=float) for outline in outlines_m])
        self.points_T = np.column_stack([corners, np.zeros(len(corners))])
        self._in_plane = np.column_stack([corners, np.ones(len(corners))]).T.copy()
        self.X_WT = np.array(X_WT, dtype=float)
        self._width, self._height = camera["width"], camera["height"]
        fx = camera.get("fx_px") or 0.5 * self._width / tan(0.5 * camera["horizontal_fov_rad"])
        self._f = (fx, camera.get("fy_px", fx))
        self._c = (camera.get("cx_px", 0.5 * (self._width - 1)), camera.get("cy_px", 0.5 * (self._height - 1)))
        self._lens = [*camera.get("distortion", []), *[0.0] * 5][:5]
        self.half = (0.5 * self._width / self._f[0], 0.5 * self._height / self._f[1])

    @classmethod
    def of(cls, scenario):
        """`Outline` of a scenario; None where it is unknown: no flat model, a moving one, one that another link than
        `robot.target_link` carries, a lens but plumb_bob."""
        models = scenario.sim.get("scene", {}).get("models", [])
        camera = scenario.sim["cameras"][0]
        outlines = _outlines(models[0], scenario) if models else None
        if not outlines or "motion" in models[0] or models[0].get("attached_to") != scenario.robot.get("target_link"):
            return None
        if not ("horizontal_fov_rad" in camera or "fx_px" in camera):
            return None
        if camera.get("distortion_model", "none") not in ("none", "plumb_bob"):
            return None
        position_m, rpy_rad = (models[0].get(key, (0.0, 0.0, 0.0)) for key in ("position_m", "rpy_rad"))
        X_WT = pose_from_rpy(position_m, rpy_rad)
        return cls(outlines, X_WT, camera)

    def pixels(self, X_WC, X_WT=None):
        """(n, 2) u, v of the outline's corners seen from X_WC [px]; None if a corner is not before the camera.

        X_WC may be a stack of m poses, (m, 4, 4): (m, n, 2), None if a corner is not before one of them.
        """
        seen = self._seen(X_WC, X_WT)
        return seen and np.stack([f * x + c for f, x, c in zip(self._f, seen, self._c)], axis=-1)

    def _seen(self, X_WC, X_WT):
        """(x, y), (n,) or (m, n) each: corners of the distorted image in normalised coordinates; else as `pixels`."""
        X_CT = inverse(X_WC) @ (self.X_WT if X_WT is None else X_WT)
        plane = X_CT[..., :3, [0, 1, 3]]  # z of all corners is 0: one product serves all poses
        points = (plane.reshape(-1, 3) @ self._in_plane).reshape(*plane.shape[:-1], -1)
        z = points[..., 2, :]
        if not z.min() > 0.0:
            return None
        x, y = points[..., 0, :] / z, points[..., 1, :] / z
        k1, k2, p1, p2, k3 = self._lens
        if any(self._lens):
            r2 = x * x + y * y
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            x, y = (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                    y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y)
        return x, y

    def border_px(self, X_WC, X_WT=None):
        """Distance of the outline from the image border [px]: negative where it is cut, -inf behind the camera.

        Args: X_WC: (4, 4); or (m, 4, 4), of which the least distance is returned.
        The image reaches from -1/2 to w - 1/2 (docs/conventions.md).
        """
        seen = self._seen(X_WC, X_WT)
        if seen is None:
            return -inf
        rooms = [min(f * x.min() + c + 0.5, size - 0.5 - (f * x.max() + c))
                 for f, x, c, size in zip(self._f, seen, self._c, (self._width, self._height))]
        return float(min(rooms))


def _outlines(model, scenario):
    if "outlines_m" in model:
        return model["outlines_m"]
    if "file" not in model:
        return None
    try:
        path = resolve_uri(model["file"], scenario._base)
        return _outlines_of(path, path.stat().st_mtime_ns)
    except ParameterError:  # another kind of file than a flat target's
        return None


@functools.lru_cache(maxsize=32)
def _outlines_of(path, _mtime_ns):
    """Outlines in a target's file, None if it has none; read again when the file has changed, not in every run."""
    return load_yaml(path).get("outlines_m")
