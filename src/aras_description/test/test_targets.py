"""Targets and launch files that come along."""

import importlib
import sys

import cv2
import numpy as np
import pytest
import roslaunch.config
import roslaunch.xmlloader
import yaml
from urdf_model import PACKAGE

NAMES = ["blob", "ellipse", "l_shape", "rectangle"]
FOCAL_PX, GOAL_DEPTH_M = 195.0, 0.59
ROUNDING_M = 5e-7  # coordinates are written to the micrometre; a centroid moves by less than one of them
SYMMETRIC = 1e-3  # third-order moments of a symmetric outline are rounding errors, orders of magnitude below this
ASYMMETRIC = 0.01  # an image-based test of asymmetry needs a share of this size to stand out of the pixels


@pytest.fixture(params=NAMES)
def target(request):
    return yaml.safe_load((PACKAGE / "targets" / f"{request.param}.yaml").read_text())


def load_outline(name):
    return np.array(yaml.safe_load((PACKAGE / "targets" / f"{name}.yaml").read_text())["outlines_m"][0])


def moments(outline):
    """Dictionary m[i, j] to order 3, area integrals by Green's theorem and Gauss-Legendre quadrature (exact)."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    following = np.roll(outline, -1, axis=0)
    m = {}
    for i in range(4):
        for j in range(4 - i):
            total = 0.0
            for node, weight in zip((nodes + 1.0) / 2.0, weights / 2.0):
                point = outline + node * (following - outline)
                total += weight * np.sum(point[:, 0]**(i + 1) * point[:, 1]**j * (following - outline)[:, 1])
            m[i, j] = total / (i + 1)
    return m


def asymmetry(outline):
    """Norm of the third-order moments about the centroid over area^2.5: no unit, no scale."""
    m = moments(outline)
    return np.linalg.norm([m[3, 0], m[2, 1], m[1, 2], m[0, 3]]) / m[0, 0]**2.5


def crosses(a, b, c, d):
    """Whether the segments a-b and c-d have a point in common."""

    def side(p, q, r):
        return np.sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) != side(a, b, d) and side(c, d, a) != side(c, d, b)


def is_simple(outline):
    """Whether no two edges that are not neighbours meet."""
    n = len(outline)
    return not any(crosses(outline[i], outline[(i + 1) % n], outline[k], outline[(k + 1) % n])
                   for i in range(n) for k in range(i + 2, n) if (k + 1) % n != i)


def test_photo_has_detail_of_every_size():
    """Half the contrast of the whole picture is left in pieces of an eighth of its width, as photographs have it."""
    photo = yaml.safe_load((PACKAGE / "targets" / "photo.yaml").read_text())
    picture = cv2.imread(str(PACKAGE / "targets" / photo["image"]["file"]), cv2.IMREAD_UNCHANGED)
    height, width = picture.shape
    assert width / height == pytest.approx(np.divide(*photo["image"]["size_m"]))
    piece = width // 8
    local = [picture[v:v + piece, u:u + piece].std()
             for v in range(0, height - piece, piece) for u in range(0, width - piece, piece)]
    assert picture.std() > 30.0
    assert np.mean(local) > 0.4 * picture.std()


def test_file_has_the_agreed_keys_and_its_own_name(target):
    assert sorted(target) == ["color_rgb", "name", "outlines_m"]
    assert target["name"] in NAMES
    assert len(target["outlines_m"]) == 1


@pytest.mark.parametrize("name", NAMES)
def test_outline_is_a_simple_counter_clockwise_polygon(name):
    outline = load_outline(name)
    assert is_simple(outline)
    assert moments(outline)[0, 0] > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_centroid_is_the_origin(name):
    m = moments(load_outline(name))
    assert np.hypot(m[1, 0], m[0, 1]) / m[0, 0] < ROUNDING_M


@pytest.mark.parametrize("name", NAMES)
def test_width_in_the_goal_image_is_50_to_85_pixels(name):
    width_px = np.ptp(load_outline(name), axis=0)[0] * FOCAL_PX / GOAL_DEPTH_M
    assert 50.0 <= width_px <= 85.0


@pytest.mark.parametrize("name", ["blob", "ellipse"])
def test_smooth_targets_have_many_vertices_and_no_corner(name):
    outline = load_outline(name)
    edges = np.roll(outline, -1, axis=0) - outline
    heading = np.arctan2(edges[:, 1], edges[:, 0])
    turn = (np.roll(heading, -1) - heading + np.pi) % (2.0 * np.pi) - np.pi
    assert len(outline) >= 200
    assert np.abs(turn).max() < np.radians(6.0)


@pytest.mark.parametrize("name", NAMES)
def test_asymmetric_targets_have_third_order_moments_and_symmetric_ones_none(name):
    share = asymmetry(load_outline(name))
    assert share > ASYMMETRIC if name in ("blob", "l_shape") else share < SYMMETRIC


@pytest.mark.parametrize("name", NAMES)
def test_orientation_is_well_defined(name):
    m = moments(load_outline(name))
    elongation = np.hypot(m[2, 0] - m[0, 2], 2.0 * m[1, 1]) / (m[2, 0] + m[0, 2])
    assert elongation > 0.2  # 0 for a disc or a square, 1 for a line


def test_script_makes_the_same_targets(monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.syspath_prepend(str(PACKAGE / "scripts"))
    made = importlib.import_module("make_targets").targets()
    assert sorted(made) == sorted(path.name for path in (PACKAGE / "targets").iterdir())
    written = {name: (PACKAGE / "targets" / name).read_bytes() for name in made}
    assert [name for name, content in made.items()
            if written[name] != (content if isinstance(content, bytes) else content.encode())] == []


def test_the_tag_is_the_one_its_file_says_and_has_a_white_margin():
    tag = yaml.safe_load((PACKAGE / "targets" / "tag.yaml").read_text())
    picture = cv2.imread(str(PACKAGE / "targets" / tag["image"]["file"]), cv2.IMREAD_UNCHANGED)
    codes = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    _, ids, _ = cv2.aruco.detectMarkers(picture, codes)
    assert ids.tolist() == [[0]] and tag["image"]["size_m"] == [0.2, 0.2]
    assert picture.shape == (400, 400) and picture[:40].min() == 255 and picture[40:60, 40:-40].max() == 0


NS = "/aras_visual_servo"


@pytest.fixture
def load(monkeypatch):
    """Function (file name, arguments...) -> roslaunch configuration, with this source tree as the package."""
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(PACKAGE.parent))
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:11401")

    def loader(name, *arguments):
        path = PACKAGE / "launch" / name
        config = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(
            str(path), config, argv=[str(path), *arguments], verbose=False)
        return config

    return loader


def node_names(config):
    return sorted(node.namespace + node.name for node in config.nodes)


def test_load_puts_the_model_on_the_parameter_server(load):
    parameters = load("load.launch").params
    assert list(parameters) == [NS + "/robot_description"]
    assert parameters[NS + "/robot_description"].value == (PACKAGE / "urdf" / "aras_arm.urdf").read_text()


def test_view_starts_positions_transforms_and_rviz(load):
    assert node_names(load("view.launch")) == [
        NS + "/joint_position_publisher", NS + "/robot_state_publisher", NS + "/rviz"]


def test_view_beside_a_simulator_starts_no_second_source_of_joint_states(load):
    config = load("view.launch", "joint_states:=false", "load:=false")
    assert node_names(config) == [NS + "/robot_state_publisher", NS + "/rviz"]
    assert NS + "/robot_description" not in config.params


def test_view_remaps_every_name_of_the_rviz_file_into_its_namespace(load):
    config = load("view.launch", "ns:=left")
    assert "/left/robot_description" in config.params
    rviz = next(node for node in config.nodes if node.name == "rviz")
    text = (PACKAGE / "rviz" / "view.rviz").read_text()
    named = {word for word in text.split() if word.startswith(NS + "/")}
    assert {source for source, _ in rviz.remap_args} == named
    assert all(target == source[len(NS) + 1:] for source, target in rviz.remap_args)


def test_scripts_named_by_launch_files_are_executable(load):
    for node in load("view.launch").nodes:
        if node.package == "aras_description":
            assert (PACKAGE / "scripts" / node.type).stat().st_mode & 0o111
