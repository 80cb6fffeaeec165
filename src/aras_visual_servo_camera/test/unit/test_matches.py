"""Matched keypoints and AprilTags: where they are found, what is refused."""

import functools

import cv2
import numpy as np
import pytest
from textured_plane import camera_info, exponential, LENS, TexturedPlane

import aras_visual_servo_camera as camera

TILTED = (0.25, -0.4, 1.6)  # of 1/Z [1/m]: 16 deg
# Displacements of the camera [m, rad]: a general one, and a turn that no point would be found in again without rotation
# invariant descriptors.
GENERAL, TURN = (0.03, -0.02, -0.05, 0.05, -0.08, 0.3), (0.0, 0.01, 0.0, 0.0, 0.0, 2.0)
# Keypoints are found to a few tenths of a pixel, those of ORB to whole pixels of its pyramid, up to 3.6 pixels wide;
# least squares over more than 30 of them leaves less than this of a point among them.
WITHIN_PX = {"orb": 0.5, "akaze": 0.4, "sift": 0.4}
SIZE = 320, 240


@functools.lru_cache(maxsize=None)
def scene(lens=(0.0,) * 5, seed=1):
    return TexturedPlane(camera_info(*SIZE, lens=lens), TILTED, waves=60, shortest_m=0.01, longest_m=0.15, seed=seed)


@functools.lru_cache(maxsize=None)
def picture(plane, twist=(0.0,) * 6):
    return plane.image(exponential(twist))


def taught(plane, **config):
    extractor = camera.MatchExtractor(plane.info, config)
    extractor.set_reference(picture(plane), 0.6)
    return extractor


def true_homography(X_CgC, plane):
    """R + t n^T / d, scaled as the features' one: n / d is (A, B, C)."""
    X_CCg = np.linalg.inv(X_CgC)
    H = X_CCg[:3, :3] + np.outer(X_CCg[:3, 3], plane)
    return H / np.linalg.svd(H)[1][1]


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS], ids=["pinhole", "lens"])
@pytest.mark.parametrize("twist", [GENERAL, TURN], ids=["general", "turn"])
@pytest.mark.parametrize("detector", ["orb", "akaze", "sift"])
def test_points_are_where_the_plane_went(detector, twist, lens):
    plane = scene(lens)
    extractor = taught(plane, detector=detector)
    goal = extractor.process(picture(plane))
    X_CgC = exponential(twist)
    seen = extractor.process(picture(plane, twist))
    assert seen.valid and seen.has_reference and seen.detector == detector and seen.fault == ""
    H = true_homography(X_CgC, plane.plane)
    where = H @ np.array([goal.as_goal_x, goal.as_goal_y, np.ones(4)])
    focals_px = np.array([[plane.info["K"][0]], [plane.info["K"][4]]])
    off_px = (np.array([seen.point_x, seen.point_y]) - where[:2] / where[2]) * focals_px
    assert np.abs(off_px).max() < WITHIN_PX[detector]
    # An entry of H changes the image by about as much times the focal length.
    assert np.abs(np.reshape(seen.homography, (3, 3)) - H).max() < 10 * WITHIN_PX[detector] / plane.info["K"][0]
    assert 30 < seen.inliers <= seen.matches <= min(seen.keypoints, seen.goal_keypoints) <= 1000
    assert seen.inliers == len(seen.match_x) == len(seen.match_y) == len(seen.match_goal_x) == len(seen.match_goal_y)
    moved = np.reshape(seen.homography, (3, 3)) @ np.array([seen.match_goal_x, seen.match_goal_y,
                                                            np.ones(seen.inliers)])
    off = moved[:2] / moved[2] - [seen.match_x, seen.match_y]
    focal_px = np.sqrt(plane.info["K"][0] * plane.info["K"][4])
    np.testing.assert_allclose(seen.rms_px, focal_px * np.sqrt(np.mean(np.sum(off**2, axis=0))), rtol=1e-9)


def test_the_goal_image_has_exactly_the_points_it_was_taught_with():
    plane = scene()
    extractor = camera.MatchExtractor(plane.info)
    view = extractor.process(picture(plane), 7)
    assert view.valid and not view.has_reference and view.point_x == []
    extractor.teach(7, 0.6)
    same = extractor.process(picture(plane), 8)
    assert (same.point_x, same.point_y) == (view.as_goal_x, view.as_goal_y)
    assert (same.homography, same.rms_px) == (np.eye(3).ravel().tolist(), 0.0)
    assert (same.z_star_m, same.reference_stamp_ns) == (0.6, 7)
    assert (same.xg, same.yg) == pytest.approx((np.mean(view.as_goal_x), np.mean(view.as_goal_y)), abs=1e-15)


@pytest.mark.parametrize("detector", ["orb", "akaze", "sift"])
def test_same_images_give_the_same_bits(detector):
    def trace():
        extractor = taught(scene(), detector=detector)
        return [extractor.process(picture(scene(), twist)).homography for twist in (GENERAL, TURN)]

    assert trace() == trace() and all(trace())


def test_the_samples_are_those_of_the_seed():
    """A quarter of the goal among another board: ten samples of four, most of them with a wrong match."""
    image = picture(scene(seed=2)).copy()
    image[:120, :160] = picture(scene())[:120, :160]

    def found(seed):
        extractor = taught(scene(), ratio=1.0, iterations=10, seed=seed)
        return repr(extractor.process(image).homography)

    results = [found(seed) for seed in range(12)]
    assert results == [found(seed) for seed in range(12)] and len(set(results)) > 1


@pytest.mark.parametrize("image, fault", [
    (np.full(SIZE[::-1], 90, np.uint8), "the image has 0 keypoints, needed at least 12"),
    (picture(scene(seed=2)), "fewer than 12 agree on where the target is")], ids=["blank", "another board"])
def test_a_view_without_the_target_is_a_value_that_says_why(image, fault):
    extractor = taught(scene())
    seen = extractor.process(image)
    assert not seen.valid and not seen.target_visible and seen.has_reference and fault in seen.fault
    assert seen.point_x == [] and seen.homography == [] and np.isnan(seen.rms_px)
    assert extractor.process(picture(scene())).valid


def test_what_cannot_be_the_goal_is_refused_and_leaves_the_goal_as_it_was():
    plane = scene()
    extractor = taught(plane)
    with pytest.raises(camera.DegenerateFeature, match="0 keypoints, allowed at least min_matches, 12"):
        extractor.set_reference(np.full(SIZE[::-1], 90, np.uint8), 0.6)
    assert extractor.process(picture(plane)).rms_px == 0.0
    with pytest.raises(camera.ShapeError, match="found 100 x 80, allowed 320 x 240"):
        extractor.set_reference(np.zeros((80, 100), np.uint8), 0.6)
    with pytest.raises(camera.ParameterError, match="z_star_m: found 0.0"):
        extractor.set_reference(picture(plane), 0.0)
    with pytest.raises(camera.ParameterError, match="reference.stamp"):
        extractor.teach(5, 0.6)


def test_faults_of_the_settings_are_listed():
    with pytest.raises(camera.ParameterError) as caught:
        camera.MatchExtractor(camera_info(), {"detector": "surf", "ratio": 0, "keypoint": 5})
    text = str(caught.value)
    assert all(part in text for part in ("vision.matches.detector: found surf, allowed", "ratio", "keypoint"))
    with pytest.raises(camera.ParameterError, match="keypoints: found 8, allowed >= min_matches, 12"):
        camera.MatchExtractor(camera_info(), {"keypoints": 8})


TAG_SIZE, SIDE_M, FINE = (320, 240), 0.16, 5
#: An edge along the pixels is drawn to half a ray, 0.1 px; a side is 60 pixels long, so that so is a part of its depth.
TAG_WITHIN_PX, WITHIN_M, WITHIN_RAD = 0.12, 0.0015, 0.006
FACING = np.array([[1.0, 0, 0, 0], [0, -1.0, 0, 0], [0, 0, -1.0, 0.5], [0, 0, 0, 1.0]])  # X_CT at the goal


def tag_at(X_CT, info, number=0, family="36h11", mirrored=False):
    """Grey image of a tag, each pixel the mean of FINE x FINE rays."""
    modules, module_px = 10, 40
    codes = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_APRILTAG_{family}"))
    inner = codes.markerSize + 2
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker  # its name before OpenCV 4.7
    texture = np.pad(draw(codes, number, inner * module_px), module_px, constant_values=230)
    if mirrored:
        texture = np.ascontiguousarray(texture[:, ::-1])
    modules = inner + 2
    width, height = info["width"], info["height"]
    fine = (np.arange(FINE) + 0.5) / FINE - 0.5
    u, v = (np.arange(n)[:, None] + fine for n in (width, height))
    grid = np.stack(np.meshgrid(u.ravel(), v.ravel()), axis=-1).reshape(-1, 1, 2)
    to_rounding = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 50, 1e-12)
    rays = cv2.undistortPointsIter(grid, np.reshape(info["K"], (3, 3)), np.array(info["D"]), np.eye(3), np.eye(3),
                                   to_rounding).reshape(-1, 2)
    H = X_CT[:3, [0, 1, 3]]
    on_tag = np.linalg.solve(H, np.column_stack([rays, np.ones(len(rays))]).T)
    x, y = on_tag[:2] / on_tag[2]
    module_m = SIDE_M / inner
    column = np.floor((x / module_m + 0.5 * modules) * module_px).astype(int)
    row = np.floor((0.5 * modules - y / module_m) * module_px).astype(int)
    inside = (column >= 0) & (row >= 0) & (column < texture.shape[1]) & (row < texture.shape[0]) & (on_tag[2] > 0)
    grey = np.full(len(x), 150.0)
    grey[inside] = texture[row[inside], column[inside]]
    return np.rint(grey.reshape(height, FINE, width, FINE).mean(axis=(1, 3))).astype(np.uint8)


def corners_of(X_CT):
    half = 0.5 * SIDE_M
    points = X_CT @ np.array([[-half, half, 0, 1], [half, half, 0, 1], [half, -half, 0, 1], [-half, -half, 0, 1]]).T
    return points[:2] / points[2]


def rotation_of(q):
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS], ids=["pinhole", "lens"])
@pytest.mark.parametrize("twist", [(0.0,) * 6, (0.05, -0.03, 0.04, 0.3, -0.4, 0.5), (0.0, 0.02, 0.0, 0.4, 0.0, 2.5)],
                         ids=["facing", "tilted", "turned"])
@pytest.mark.parametrize("family, number", [("36h11", 0), ("25h9", 3)])
def test_corners_and_pose_are_the_true_ones(family, number, twist, lens):
    info = camera_info(*TAG_SIZE, lens=lens)
    X_CT = FACING @ exponential(twist)
    extractor = camera.TagExtractor(info, {"family": family, "id": number, "size_m": SIDE_M})
    seen = extractor.process(tag_at(X_CT, info, number, family))
    assert seen.valid and seen.target_visible and seen.fault == "" and (seen.tags, seen.id) == (1, number)
    off_px = (np.array([seen.point_x, seen.point_y]) - corners_of(X_CT)) * info["K"][0]
    assert np.abs(off_px).max() < TAG_WITHIN_PX
    assert (seen.xg, seen.yg) == pytest.approx(corners_of(X_CT).mean(axis=1), abs=TAG_WITHIN_PX / info["K"][0])
    np.testing.assert_allclose(seen.position_m, X_CT[:3, 3], atol=WITHIN_M)
    if not np.allclose(twist, 0.0):  # seen head-on, two poses explain the corners nearly alike
        off = rotation_of(seen.orientation).T @ X_CT[:3, :3]
        assert np.arccos(np.clip((np.trace(off) - 1) / 2, -1, 1)) < WITHIN_RAD
    assert 0.0 <= seen.pose_error <= seen.other_pose_error


def test_the_homography_is_that_of_the_displacement_from_the_goal():
    info = camera_info(*TAG_SIZE)
    extractor = camera.TagExtractor(info)
    goal = extractor.process(tag_at(FACING, info), 5)
    assert goal.valid and goal.homography == [] and goal.position_m == []  # no reference, no size
    extractor.teach(5, 0.5)
    X_CCg = exponential((0.03, -0.02, 0.05, 0.05, -0.08, 0.3))
    seen = extractor.process(tag_at(X_CCg @ FACING, info))
    H = X_CCg[:3, :3] + np.outer(X_CCg[:3, 3], [0.0, 0.0, 1.0 / 0.5])
    np.testing.assert_allclose(np.reshape(seen.homography, (3, 3)), H / np.linalg.svd(H)[1][1], atol=0.005)
    assert (seen.has_reference, seen.z_star_m, seen.reference_stamp_ns) == (True, 0.5, 5)


@pytest.mark.parametrize("case, fault", [
    ("behind", "the image does not show tag 0 of 36h11"), ("half outside", "the image does not show tag 0 of 36h11"),
    ("far", "tag 0 of 36h11 is too small: a side is"), ("other", "the image does not show tag 0 of 36h11, but 3"),
    ("twice", "the image shows 2 times tag 0 of 36h11"), ("blank", "the image does not show tag 0 of 36h11")])
def test_a_view_without_a_usable_tag_is_a_value_that_says_why(case, fault):
    info = camera_info(*TAG_SIZE)
    far, outside, right = FACING.copy(), FACING.copy(), FACING.copy()
    far[2, 3], outside[0, 3], right[0, 3] = 1.0, 0.5 * TAG_SIZE[0] / info["K"][0] * 0.5, 0.11
    image = {"behind": lambda: tag_at(FACING, info, mirrored=True), "half outside": lambda: tag_at(outside, info),
             "far": lambda: tag_at(far, info), "other": lambda: tag_at(FACING, info, 3),
             "blank": lambda: np.full(TAG_SIZE[::-1], 90, np.uint8),
             "twice": lambda: np.hstack([tag_at(right, info)[:, 160:], tag_at(right, info)[:, 160:]])}[case]()
    extractor = camera.TagExtractor(info, {"size_m": SIDE_M, "min_side_px": 40})
    extractor.set_reference(tag_at(FACING, info), 0.5)
    seen = extractor.process(image)
    assert fault in seen.fault and not seen.valid and not seen.target_visible and seen.has_reference
    assert seen.point_x == [] and seen.homography == [] and seen.position_m == [] and np.isnan(seen.xg)
    with pytest.raises(camera.DegenerateFeature, match="tag reference"):
        extractor.set_reference(image, 0.5)
    home = extractor.process(tag_at(FACING, info))
    assert home.has_reference and np.allclose(home.homography, np.eye(3).ravel())


def test_a_tag_beyond_the_fold_of_the_lens_is_a_value_that_says_why():
    image = tag_at(FACING, camera_info(*TAG_SIZE))
    seen = camera.TagExtractor(camera_info(*TAG_SIZE, lens=(-30.0, 0.0, 0.0, 0.0, 0.0))).process(image)
    assert (seen.fault, seen.tags) == ("tag 0 of 36h11 lies where the lens shows nothing", 1)
    assert not seen.valid and not seen.target_visible and seen.point_x == []


def test_same_images_give_the_same_bits_and_bad_settings_are_listed():
    info = camera_info(*TAG_SIZE)
    image = tag_at(FACING @ exponential((0.0, 0.0, 0.0, 0.3, 0.2, 0.1)), info)
    one, other = (camera.TagExtractor(info, {"size_m": SIDE_M}).process(image) for _ in range(2))
    assert (one.point_x, one.position_m, one.orientation) == (other.point_x, other.position_m, other.orientation)
    with pytest.raises(camera.ParameterError) as caught:
        camera.TagExtractor(info, {"family": "qr", "size_m": 0, "numbr": 5})
    assert all(part in str(caught.value) for part in ("vision.tag.family: found qr, allowed", "size_m", "numbr"))
    with pytest.raises(camera.ShapeError, match="found 100 x 80, allowed 320 x 240"):
        camera.TagExtractor(info).process(np.zeros((80, 100), np.uint8))
    with pytest.raises(camera.ParameterError, match="z_star_m: found 0.0"):
        camera.TagExtractor(info).set_reference(image, 0.0)
    with pytest.raises(camera.ParameterError, match="reference.stamp"):
        camera.TagExtractor(info).teach(5, 0.6)
