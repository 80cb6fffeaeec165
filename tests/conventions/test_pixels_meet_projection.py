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
NARROW = {"width": 320, "height": 240, "horizontal_fov_rad": 1.41, "distortion_model": "plumb_bob"}
FISHEYE = {"width": 640, "height": 640, "horizontal_fov_rad": np.radians(200.0), "cutoff_angle_rad": np.radians(100.0),
           "distortion_model": "equidistant", "distortion": [-0.03, 0.004, -0.0005, 0.00002]}
CAMERAS = [{**NARROW, "distortion": [0.0, 0.0, 0.0, 0.0, 0.0]},
           {**NARROW, "distortion": [-0.3306, 0.117, 0.001, -0.0008, 0.0]}, FISHEYE]

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


def seen_and_projected(X_CT, camera):
    """What the camera node's core makes of a rendered target, the moments of its projection, and fx.

    Args:
        X_CT: (4, 4) pose of the target in the camera's frame; camera: size, field and lens.
    """
    from aras_visual_servo_camera import MomentExtractor
    from aras_visual_servo_sim import Simulation
    from scipy.spatial.transform import Rotation

    import aras_visual_servo as avs

    target = "package://aras_description/targets/blob.yaml"
    # The camera hangs still.
    X_WC = np.eye(4)
    X_WC[:3, :3], X_WC[:3, 3] = np.diag([1.0, -1.0, -1.0]), (0, 0, 1)
    X_WT = X_WC @ X_CT
    camera = {"name": "camera", "frame": "camera_optical_frame", "rate_hz": 30.0, **camera}
    config = {"cameras": [camera], "scene": {"background_rgb": [230, 230, 230],
                                             "models": [{"name": "target", "file": target}]}}
    simulation = Simulation(URDF, config, {}, avs.package_paths())
    simulation.set_model_pose("target", X_WT[:3, 3], Rotation.from_matrix(X_WT[:3, :3]).as_quat())
    np.testing.assert_allclose(simulation.camera_pose("camera"), X_WC, atol=1e-12)

    extractor = MomentExtractor(simulation.camera_info("camera"),
                                {"object": "dark", "segmentation": "coverage", "object_grey": 20,
                                 "background_grey": 230})
    seen = extractor.process(simulation.render("camera"))

    outline = np.array(avs.load_yaml(avs.resolve_uri(target))["outlines_m"][0])
    # The sides are subdivided: projection keeps them straight, the moments are integrated exactly either way.
    points_T = np.column_stack([outline, np.zeros(len(outline)), np.ones(len(outline))])
    points_C = (X_CT @ points_T.T)[:3]
    return seen, polygon_moments((points_C[:2] / points_C[2]).T), simulation.camera_info("camera")["K"][0]


@pytest.mark.parametrize("camera", CAMERAS, ids=["pinhole", "plumb_bob", "fisheye"])
@pytest.mark.parametrize("pose", POSES)
def test_moments_of_a_rendered_polygon_are_those_of_its_projection(pose, camera):
    X_TC = np.eye(4)
    X_TC[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ rotation(*pose[3:])
    X_TC[:3, 3] = pose[:3]
    seen, (area, xg, yg, alpha), focal = seen_and_projected(np.linalg.inv(X_TC), camera)
    assert seen.target_visible and seen.valid and not seen.touches_border
    assert seen.xg * focal == pytest.approx(xg * focal, abs=CENTROID_PX)
    assert seen.yg * focal == pytest.approx(yg * focal, abs=CENTROID_PX)
    assert seen.area == pytest.approx(area, rel=AREA_SHARE)
    assert np.sin(seen.alpha - alpha) == pytest.approx(0.0, abs=ALPHA_RAD)


@pytest.mark.parametrize("azimuth", [0.3, 2.0])
def test_a_target_on_its_way_out_of_a_wide_view_is_measured_right_or_not_at_all(azimuth):
    from scipy.spatial.transform import Rotation
    valid = []
    for degrees in (40, 55, 66, 75, 82, 90, 98, 103):
        theta = np.radians(degrees)
        ray = np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)])
        X_CT = np.eye(4)
        X_CT[:3, :3] = np.diag([1.0, -1.0, -1.0])  # its front to the camera
        axis = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        X_CT[:3, :3] = Rotation.from_rotvec(theta * axis).as_matrix() @ X_CT[:3, :3]
        X_CT[:3, 3] = 0.5 * ray
        seen, (area, xg, yg, _), focal = seen_and_projected(X_CT, FISHEYE)
        valid.append(seen.valid)
        if seen.valid:
            # In pixels about the target: normalised coordinates stretch by 1 / cos^2 along the radius.
            assert np.hypot(seen.xg - xg, seen.yg - yg) * focal * np.cos(theta) ** 2 < CENTROID_PX, degrees
            assert seen.area == pytest.approx(area, rel=AREA_SHARE), degrees
    assert valid[:2] == [True, True] and not any(valid[4:])  # the limit is 80 degrees
