"""Corners of a square, measured in rendered images, against projections made without the simulator.

A corner is where polynomials meet that are fitted to the square's edges, each edge found in every column (or row) it
crosses by summing coverage. Up to 90 degrees from the axis OpenCV projects; beyond, the formula of its fisheye model,
written out.
"""
import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from aras_visual_servo_sim import Simulation

REPROJECTION_PX = 0.01  # promised; rounding to 8 bits is 0.29 / 255 px rms a pixel, 0.0016 px a column; the rest is fit
URDF = """<robot name="eye"><link name="world"/><joint name="mount" type="fixed"><parent link="world"/>
<child link="optical"/></joint><link name="optical"/></robot>"""
KANNALA_BRANDT = [-0.03, 0.004, -0.0005, 0.00002]
PINHOLE = {"width": 640, "height": 480, "horizontal_fov_rad": 1.41}
FISHEYE = {"width": 1080, "height": 1080, "distortion_model": "equidistant", "distortion": KANNALA_BRANDT}
LENSES = {
    "pinhole": {**PINHOLE, "cx_px": 311.3, "cy_px": 247.9},
    "plumb_bob": {**PINHOLE, "distortion_model": "plumb_bob", "distortion": [-0.3306, 0.117, 0.001, -0.0015, 0.0]},
    "rational": {**PINHOLE, "distortion_model": "rational_polynomial",
                 "distortion": [0.2, 0.05, 0.001, 0.0005, 0.01, 0.35, 0.1, 0.01]},
    "fisheye": {**FISHEYE, "horizontal_fov_rad": np.radians(160.0)},
    "fisheye_200": {**FISHEYE, "horizontal_fov_rad": np.radians(200.0), "cutoff_angle_rad": np.radians(100.0)},
}
SIDE_M = 0.18
# The square's middle: angle from the axis and azimuth [deg]; then how it is turned from facing the camera [rad].
AHEAD = [(0, 0, 0.3, 0.1, -0.2), (12, 40, -0.4, 0.3, 0.1), (14, 200, 1.0, -0.2, 0.4), (10, 300, -1.2, 0.3, 0.3)]
WIDE = [(35, 10, 0.3, 0.2, -0.1), (50, 135, -0.5, 0.2, 0.3), (52, 230, 0.2, -0.3, 0.2), (50, 320, 0.9, 0.1, -0.3)]
BESIDE = [(82, 20, 0.4, 0.1, 0.2), (84, 110, -0.3, 0.1, -0.1), (83, 200, 0.8, -0.2, 0.1), (84, 290, 0.1, 0.15, 0.1)]
CASES = [("pinhole", AHEAD), ("plumb_bob", AHEAD), ("rational", AHEAD), ("fisheye", AHEAD + WIDE),
         ("fisheye_200", WIDE + BESIDE)]


def placed(view, range_m=0.5):
    """Pose of the square in the camera's frame, and its corners there, (4, 3), in turn."""
    theta, azimuth = np.radians(view[:2])
    ray = np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)])
    across = np.cross([0.0, 0.0, 1.0], -ray)
    turn = Rotation.from_rotvec([np.pi, 0.0, 0.0])
    if np.linalg.norm(across) > 0.0:
        turn = Rotation.from_rotvec(across / np.linalg.norm(across) * np.arctan2(np.linalg.norm(across), -ray[2]))
    turn = turn * Rotation.from_euler("zxy", view[2:])
    corners = 0.5 * SIDE_M * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return range_m * ray, turn, turn.apply(corners) + range_m * ray


def project(points, info):
    """(n, 3) points in the camera's frame to pixels, nothing of the simulator but camera_info."""
    K, D = np.array(info["K"]).reshape(3, 3), np.array(info["D"])
    if info["distortion_model"] != "equidistant":
        return cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, D)[0].reshape(-1, 2)
    theta = np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    r = theta * (1 + D[0] * theta**2 + D[1] * theta**4 + D[2] * theta**6 + D[3] * theta**8)
    pixels = np.column_stack([K[0, 2] + K[0, 0] * r * np.cos(azimuth), K[1, 2] + K[1, 1] * r * np.sin(azimuth)])
    ahead = theta < np.radians(89.0)
    if ahead.any():
        flat = (points[ahead, :2] / points[ahead, 2:]).reshape(-1, 1, 2)
        opencv = cv2.fisheye.distortPoints(flat, K, D).reshape(-1, 2)
        np.testing.assert_allclose(pixels[ahead], opencv, atol=1e-6)
    return pixels


def edge_from(weights, corner, along):
    """Fits the edge that leaves a corner.

    Args:
        weights: coverage (h, w), 0 .. 1.
        corner: roughly where it is (u, v); along: (n, 2) points of the edge, leaving the corner; for windows only.
    Returns:
        (axis, polynomial): coordinate 1 - axis of the edge as a function of coordinate `axis` less the corner's.
    """
    along = along[np.linalg.norm(along - corner, axis=1) < 90.0]
    axis = int(np.ptp(along[:, 1]) > np.ptp(along[:, 0]))
    image = weights.T if axis else weights  # now [across, along]
    a, b = along[:, axis], along[:, 1 - axis]
    order = np.argsort(a)
    assert (np.abs(np.diff(b)) < 1.5 * np.abs(np.diff(a))).all(), "the edge turns too far to be one function"
    sign = 1 if a[-1] > a[0] else -1
    first, last = corner[axis] + sign * 6, a[-1] - sign * 6
    columns = np.arange(np.ceil(min(first, last)), np.floor(max(first, last)) + 1).astype(int)
    found = []
    for column in columns:
        middle = np.interp(column, a[order], b[order])
        low, high = int(np.floor(middle)) - 2, int(np.ceil(middle)) + 2
        covered = image[low:high + 1, column].sum()
        found.append(high + 0.5 - covered if image[high, column] > image[low, column] else low - 0.5 + covered)
    x = (columns - corner[axis]) / 100.0
    degree = 4
    # What is found is the mean over a column's width: fit the mean of the powers.
    means = [((x + 0.005) ** (k + 1) - (x - 0.005) ** (k + 1)) / (k + 1) / 0.01 for k in range(degree + 1)]
    return axis, np.linalg.lstsq(np.column_stack(means), np.array(found), rcond=None)[0]


def meeting_point(edges, corner):
    """Where two fitted edges meet [px]."""
    from scipy.optimize import fsolve

    def apart(p):
        return [p[1 - axis] - np.polyval(fit[::-1], (p[axis] - corner[axis]) / 100.0) for axis, fit in edges]
    return fsolve(apart, corner, xtol=1e-12)


def errors_of(lens, views):
    camera = {"name": "camera", "frame": "optical", "encoding": "mono8", "rate_hz": 30.0, **LENSES[lens]}
    outline = 0.5 * SIDE_M * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    scene = {"background_rgb": [0, 0, 0], "models": [{"name": "square", "outlines_m": [outline.tolist()],
                                                      "color_rgb": [255, 255, 255]}]}
    simulation = Simulation(URDF, {"cameras": [camera], "scene": scene}, {})
    info, errors = simulation.camera_info("camera"), []
    for view in views:
        position, turn, corners = placed(view)
        simulation.set_model_pose("square", position, turn.as_quat())
        weights = np.array(simulation.render("camera"), dtype=float) / 255.0
        pixels = project(corners, info)
        steps = np.linspace(0.0, 1.0, 50)[:, None]
        for k in range(4):
            edges = [edge_from(weights, pixels[k], project(corners[k] + steps * (corners[j] - corners[k]), info))
                     for j in ((k + 1) % 4, (k - 1) % 4)]
            errors.append(meeting_point(edges, pixels[k]) - pixels[k])
    return np.linalg.norm(errors, axis=1)


@pytest.mark.parametrize("lens, views", CASES, ids=[case[0] for case in CASES])
def test_corners_are_where_they_project(lens, views):
    errors = errors_of(lens, views)
    print(f"{lens}: {len(errors)} corners, worst {errors.max():.4f} px, rms {np.sqrt((errors ** 2).mean()):.4f} px")
    assert errors.max() < REPROJECTION_PX
