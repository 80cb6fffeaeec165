"""Simulator and camera node agree on where things are: what the moments see of a rendered polygon is its projection.

The exact projection is computed here, from camera_info and the true poses alone.
"""
import numpy as np
import pytest

CENTROID_PX = 0.02      # promised; 8-bit coverage leaves about 0.002 px for a target of this size
AREA_SHARE = 1e-3       # one grey level in 255 along the outline of a target 60 px wide
ALPHA_RAD = 3e-4
POSES = [               # camera over the target: x, y, z [m], roll, pitch, yaw [rad] of the camera
    (0.0, 0.0, 0.60, 0.0, 0.0, 0.0), (0.11, -0.07, 0.55, 0.0, 0.0, 0.5), (-0.05, 0.04, 0.70, 0.15, -0.1, -1.0),
    (0.03, 0.08, 0.65, -0.2, 0.12, 2.5)]
LENSES = [[0.0, 0.0, 0.0, 0.0, 0.0], [-0.3306, 0.117, 0.001, -0.0008, 0.0]]

URDF = """<robot name="eye"><link name="world"/>
<joint name="mount" type="fixed"><parent link="world"/><child link="camera_optical_frame"/>
<origin xyz="0 0 1" rpy="3.141592653589793 0 0"/></joint><link name="camera_optical_frame"/></robot>"""


def rotation(roll, pitch, yaw):
    from scipy.spatial.transform import Rotation
    return Rotation.from_euler("xyz", [roll, pitch, yaw]).as_matrix()


def polygon_moments(xy):
    """m00, centroid and orientation of a polygon, by Green's theorem."""
    x, y = xy.T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    c = x * y1 - x1 * y
    area = c.sum() / 2
    xg, yg = (c * (x + x1)).sum() / (6 * area), (c * (y + y1)).sum() / (6 * area)
    mu20 = (c * (x * x + x * x1 + x1 * x1)).sum() / 12 - area * xg ** 2
    mu02 = (c * (y * y + y * y1 + y1 * y1)).sum() / 12 - area * yg ** 2
    mu11 = (c * (x * y1 + 2 * x * y + 2 * x1 * y1 + x1 * y)).sum() / 24 - area * xg * yg
    sign = np.sign(area)
    return abs(area), xg, yg, 0.5 * np.arctan2(2 * sign * mu11, sign * (mu20 - mu02))


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("pose", POSES)
def test_moments_of_a_rendered_polygon_are_those_of_its_projection(pose, lens):
    from aras_visual_servo_camera import MomentExtractor
    from aras_visual_servo_sim import Simulation
    from scipy.spatial.transform import Rotation

    from aras_visual_servo_controller.scenario_files import load_yaml, package_paths, resolve_uri

    target = "package://aras_description/targets/blob.yaml"
    # The camera hangs still; the target is placed where the camera pose asked for would see it.
    X_TC = np.eye(4)
    X_TC[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ rotation(*pose[3:])
    X_TC[:3, 3] = pose[:3]
    X_WC = np.eye(4)
    X_WC[:3, :3], X_WC[:3, 3] = np.diag([1.0, -1.0, -1.0]), (0, 0, 1)
    X_WT = X_WC @ np.linalg.inv(X_TC)
    camera = {"name": "camera", "frame": "camera_optical_frame", "width": 320, "height": 240,
              "horizontal_fov_rad": 1.41, "rate_hz": 30.0, "distortion_model": "plumb_bob", "distortion": lens}
    config = {"cameras": [camera], "scene": {"background_rgb": [230, 230, 230],
                                             "models": [{"name": "target", "file": target}]}}
    simulation = Simulation(URDF, config, {}, package_paths())
    simulation.set_model_pose("target", X_WT[:3, 3], Rotation.from_matrix(X_WT[:3, :3]).as_quat())
    np.testing.assert_allclose(simulation.camera_pose("camera"), X_WC, atol=1e-12)

    extractor = MomentExtractor(simulation.camera_info("camera"),
                                {"object": "dark", "segmentation": "coverage", "object_grey": 20,
                                 "background_grey": 230})
    seen = extractor.process(simulation.render("camera"))

    outline = np.array(load_yaml(resolve_uri(target))["outlines_m"][0])
    # The sides are subdivided: projection keeps them straight, the moments are integrated exactly either way.
    points_T = np.column_stack([outline, np.zeros(len(outline)), np.ones(len(outline))])
    points_C = (np.linalg.inv(X_TC) @ points_T.T)[:3]
    area, xg, yg, alpha = polygon_moments((points_C[:2] / points_C[2]).T)

    focal = simulation.camera_info("camera")["K"][0]
    assert seen.target_visible and seen.valid and not seen.touches_border
    assert seen.xg * focal == pytest.approx(xg * focal, abs=CENTROID_PX)
    assert seen.yg * focal == pytest.approx(yg * focal, abs=CENTROID_PX)
    assert seen.area == pytest.approx(area, rel=AREA_SHARE)
    assert np.sin(seen.alpha - alpha) == pytest.approx(0.0, abs=ALPHA_RAD)
