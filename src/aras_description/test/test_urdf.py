"""The robot models: tree, limits, masses, frames, meshes, forward kinematics."""

import importlib
import re
import sys

import numpy as np
import pytest
import yaml

from urdf_model import PACKAGE, UrdfModel, origin, stl_triangles

FIVE, SIX = "aras_arm", "aras_arm_6axis"
MODELS = {name: UrdfModel(PACKAGE / "urdf" / f"{name}.urdf") for name in (FIVE, SIX)}
SHARED = [("gantry", "prismatic", "world", "slider"), ("J0", "fixed", "slider", "link0"),
          ("J1", "revolute", "link0", "link1"), ("J2", "revolute", "link1", "link2"),
          ("J3", "revolute", "link2", "link3"), ("J6", "continuous", "link5", "link6"),
          ("camera_joint", "fixed", "link6", "camera_link"),
          ("camera_optical_joint", "fixed", "camera_link", "camera_optical_frame")]
CHAINS = {FIVE: SHARED + [("J5", "revolute", "link3", "link5")],
          SIX: SHARED + [("J4", "revolute", "link3", "link4"), ("J5", "revolute", "link4", "link5")]}
MOVING = {FIVE: ["J1", "J2", "J3", "J5", "J6", "gantry"], SIX: ["J1", "J2", "J3", "J4", "J5", "J6", "gantry"]}
MASSES_KG = {FIVE: {"slider": 1.5957, "link0": 5.272, "link1": 2.2792, "link2": 3.6544, "link3": 1.6841,
                    "link5": 1.32285, "link6": 0.3641, "camera_link": 0.1}}
MASSES_KG[SIX] = {**MASSES_KG[FIVE], "link3": 1.0641, "link4": 0.62}  # the published forearm, cut in two
LINKS = [(name, link) for name in MODELS for link in MASSES_KG[name]]
GOAL = {"gantry": 0.05, "J2": -0.09, "J3": 0.045, "J5": 0.045}
START = {"gantry": -0.1, "J2": np.radians(20.0), "J3": np.radians(-15.0), "J5": np.radians(-5.0),
         "J6": np.radians(10.0)}
ROUNDING = 64 * np.finfo(float).eps  # a chain of ten products of numbers near 1
HALF_A_DIGIT = 1e-8  # inertias of the six-axis forearm are written to 1e-8 kg m^2, twice that after moving them


@pytest.fixture(scope="module", params=MODELS)
def robot(request):
    """Name of the model; `arm` is the model itself."""
    return request.param


@pytest.fixture(scope="module")
def arm(robot):
    return MODELS[robot]


def camera_position(q):
    """Closed form of the optical centre in the world for J1 = 0 (README.md, forward kinematics) [m]."""
    a, b, c = q["J2"], q["J2"] + q["J3"], q["J2"] + q["J3"] + q["J5"]
    reach = 0.25 * np.sin(a) + 0.16 * np.sin(b) + (0.0718 + 0.0334) * np.sin(c)
    drop = 0.02888 + 0.168 + 0.132 + 0.25 * np.cos(a) + 0.16 * np.cos(b) + (0.0718 + 0.0334) * np.cos(c)
    return np.array([-reach, q["gantry"], 1.6263 - drop])


def test_joints_connect_their_parents_and_children(robot, arm):
    found = {(name, joint.get("type"), joint.find("parent").get("link"), joint.find("child").get("link"))
             for name, joint in arm.joints.items() if name not in ("rail_mount", "stand_optical_joint")}
    assert found == set(CHAINS[robot])


def test_place_of_a_camera_under_the_arm_hangs_on_nothing_that_moves(arm):
    joint = arm.joints["stand_optical_joint"]
    assert (joint.get("type"), joint.find("parent").get("link"), joint.find("child").get("link")) == (
        "fixed", "world", "stand_optical_frame")
    assert joint.find("origin").get("rpy") == "0 0 0"  # z, along which it looks, is up


def test_world_is_the_only_root(arm):
    assert set(arm.links) - set(arm.parent_joint) == {"world"}
    assert len(arm.joints) == len(arm.links) - 1


def test_moving_joints_are_the_documented_ones(robot, arm):
    assert sorted(name for name, joint in arm.joints.items() if joint.get("type") != "fixed") == MOVING[robot]


def test_limits_and_dynamics_equal_the_documented_ones(robot, arm):
    documented = yaml.safe_load((PACKAGE / "config" / "joint_limits.yaml").read_text())["joint_limits"]
    assert sorted(documented) == sorted(set().union(*MOVING.values()))
    for name, entry in documented.items():
        if name not in MOVING[robot]:
            continue
        unit = "m" if name == "gantry" else "rad"
        limit, dynamics = arm.limit(name), arm.joints[name].find("dynamics")
        assert limit["effort"] == entry["max_effort_n" if name == "gantry" else "max_effort_n_m"]
        assert limit["velocity"] == entry[f"max_velocity_{unit}_s"]
        assert ("lower" in limit) == entry["has_position_limits"]
        if entry["has_position_limits"]:
            assert [limit["lower"], limit["upper"]] == [entry[f"min_position_{unit}"], entry[f"max_position_{unit}"]]
        assert float(dynamics.get("damping")) == entry["damping"]
        assert float(dynamics.get("friction")) == entry["friction"]
        assert entry["source"]


def test_masses_are_the_documented_ones(robot, arm):
    assert {name: arm.inertial(name)[0] for name in arm.links if arm.inertial(name)} == MASSES_KG[robot]


def test_forearm_of_the_six_axis_arm_adds_up_to_the_published_one():
    mass, com, inertia = MODELS[FIVE].inertial("link3")
    about_origin = inertia + mass * (com @ com * np.eye(3) - np.outer(com, com))
    first, total = -mass * com, -about_origin
    for link, offset in (("link3", 0.0), ("link4", 0.07)):
        mass, com, inertia = MODELS[SIX].inertial(link)
        com = com + [0.0, 0.0, offset]
        first, total = first + mass * com, total + inertia + mass * (com @ com * np.eye(3) - np.outer(com, com))
    np.testing.assert_allclose(first, 0.0, atol=HALF_A_DIGIT)
    np.testing.assert_allclose(total, 0.0, atol=2.0 * HALF_A_DIGIT)


@pytest.mark.parametrize("link", ["link2", "link5", "link6", "camera_link", "camera_optical_frame"])
def test_both_arms_are_in_the_same_place_while_the_forearm_is_not_rolled(link):
    q = {"gantry": 0.2, "J1": 0.3, "J2": -0.4, "J3": 0.7, "J5": 0.5, "J6": -1.1}
    np.testing.assert_allclose(MODELS[SIX].link_pose(link, q), MODELS[FIVE].link_pose(link, q), atol=ROUNDING)


def test_positive_j4_turns_the_wrist_about_the_forearm():
    R = MODELS[SIX].link_pose("link3", START)[:3, :3].T @ MODELS[SIX].link_pose("link5", {**START, "J4": 0.4})[:3, :3]
    R_five = MODELS[FIVE].link_pose("link3", START)[:3, :3].T @ MODELS[FIVE].link_pose("link5", START)[:3, :3]
    c, s = np.cos(0.4), np.sin(0.4)
    np.testing.assert_allclose(R, np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ R_five, atol=ROUNDING)


@pytest.mark.parametrize("robot_name, link", LINKS)
def test_inertia_is_that_of_a_body(robot_name, link):
    arm = MODELS[robot_name]
    principal = np.linalg.eigvalsh(arm.inertial(link)[2])
    assert principal[0] > 0.0
    assert principal[0] + principal[1] >= principal[2]


@pytest.mark.parametrize("robot_name, link", LINKS)
def test_mass_fits_inside_the_visual_shape(robot_name, link):
    """Centre of mass in the meshes' box, and along each axis a radius of gyration that the box allows."""
    arm = MODELS[robot_name]
    mass, com, inertia = arm.inertial(link)
    points = np.concatenate([stl_triangles(PACKAGE / name.split("/", 3)[3]).reshape(-1, 3)
                             for name in arm.mesh_files(link)])
    low, high = points.min(axis=0), points.max(axis=0)
    assert np.all(low <= com) and np.all(com <= high)
    gyration = np.sqrt((np.trace(inertia) / 2.0 - np.diag(inertia)) / mass)
    assert np.all(gyration <= np.maximum(high - com, com - low))


def test_every_moving_joint_has_an_effort_transmission(robot, arm):
    interfaces = {tag.find("joint").get("name"): tag.find("joint/hardwareInterface").text
                  for tag in arm.root.findall("transmission")}
    assert sorted(interfaces) == MOVING[robot]
    assert set(interfaces.values()) == {"hardware_interface/EffortJointInterface"}


def test_every_link_with_mass_has_collision_geometry_of_primitives(robot, arm):
    for link in MASSES_KG[robot]:
        shapes = arm.links[link].findall("collision/geometry/*")
        assert shapes and {shape.tag for shape in shapes} <= {"box", "cylinder", "sphere"}


def test_optical_frame_is_right_down_forward_of_the_camera_body(arm):
    R_WL, R_WC = (arm.link_pose(link, START)[:3, :3] for link in ("camera_link", "camera_optical_frame"))
    R = R_WL.T @ R_WC
    right_down_forward = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]).T
    np.testing.assert_allclose(R, right_down_forward, atol=ROUNDING)


def test_image_right_is_along_the_gantry_and_down_is_along_world_x(arm):
    X_WC = arm.link_pose("camera_optical_frame", {})
    np.testing.assert_allclose(X_WC[:3, :3], [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]], atol=ROUNDING)
    np.testing.assert_allclose(X_WC[:3, 3], [0.0, 0.0, 0.78222], atol=ROUNDING)


@pytest.mark.parametrize("q", [GOAL, START], ids=["goal", "start"])
def test_camera_looks_straight_down_from_where_the_closed_form_says(arm, q):
    X_WC = arm.link_pose("camera_optical_frame", q)
    np.testing.assert_allclose(X_WC[:3, 3], camera_position(q), atol=ROUNDING)
    np.testing.assert_allclose(X_WC[:3, 2], [0.0, 0.0, -1.0], atol=ROUNDING)


def test_goal_is_0_59_m_above_the_plane_at_0_1934_m(arm):
    half_a_micrometre = 5e-7  # the README gives micrometres
    np.testing.assert_allclose(arm.link_pose("camera_optical_frame", GOAL)[:3, 3], [0.029667, 0.05, 0.783394],
                               atol=half_a_micrometre)


def test_start_turns_the_image_by_10_degrees(arm):
    R = arm.link_pose("camera_optical_frame", GOAL)[:3, :3].T @ arm.link_pose("camera_optical_frame", START)[:3, :3]
    assert np.arctan2(R[1, 0], R[0, 0]) == pytest.approx(np.radians(10.0), abs=ROUNDING)


def test_positive_j1_turns_the_arm_about_the_downward_axis(arm):
    R = arm.link_pose("link1", {"J1": 0.3})[:3, :3]
    assert np.arctan2(R[0, 1], R[1, 1]) == pytest.approx(0.3, abs=ROUNDING)


def test_camera_tag_has_the_published_camera(arm):
    sensor = arm.root.find("gazebo[@reference='camera_link']/sensor")
    plugin = sensor.find("plugin")
    assert [sensor.find(path).text for path in (
        "update_rate", "camera/horizontal_fov", "camera/image/width", "camera/image/height")] == [
            "30.0", "1.41", "320", "240"]
    assert plugin.get("filename") == "libgazebo_ros_camera.so"
    assert [plugin.find(key).text for key in ("cameraName", "imageTopicName", "cameraInfoTopicName", "frameName")] == [
        "camera", "image_raw", "camera_info", "camera_optical_frame"]


def test_the_free_camera_is_the_arm_s_camera_behind_a_floating_joint():
    free = UrdfModel(PACKAGE / "urdf" / "free_camera.urdf")
    assert [(joint.get("type"), joint.find("parent").get("link"), joint.find("child").get("link"))
            for joint in free.joints.values()] == [("floating", "world", "camera_optical_frame"),
                                                   ("fixed", "camera_optical_frame", "camera_link")]
    arm = MODELS[FIVE]
    X_WC, X_WL = (arm.link_pose(link, {}) for link in ("camera_optical_frame", "camera_link"))
    np.testing.assert_allclose(origin(free.joints["camera_body_joint"]), np.linalg.inv(X_WC) @ X_WL, atol=ROUNDING)
    assert free.mesh_files("camera_link") == arm.mesh_files("camera_link")
    assert free.links["camera_link"].find("inertial/mass").get("value") == "0.1"


def test_meshes_exist_and_each_is_used():
    names = [name for arm in MODELS.values() for name in arm.mesh_files()]
    used = {name.rsplit("/", 1)[1] for name in names}
    assert all(name.startswith("package://aras_description/meshes/visual/") for name in names)
    assert used == {path.name for path in (PACKAGE / "meshes" / "visual").iterdir()}


@pytest.mark.parametrize("path", sorted((PACKAGE / "meshes" / "visual").iterdir()), ids=lambda path: path.stem)
def test_mesh_is_closed_and_faces_outwards(path):
    triangles = stl_triangles(path)
    corners = np.round(triangles * 1e5).astype(int)  # the grid that the vertices were rounded to
    edges = np.concatenate([corners[:, [i, (i + 1) % 3]] for i in range(3)]).reshape(-1, 6)
    forward, backward = np.sort(edges.view("i8,i8,i8,i8,i8,i8").ravel()), edges[:, [3, 4, 5, 0, 1, 2]].copy()
    assert np.array_equal(forward, np.sort(backward.view("i8,i8,i8,i8,i8,i8").ravel()))
    assert np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) > 0.0


def test_materials_are_defined(arm):
    defined = {material.get("name") for material in arm.root.findall("material")}
    assert {material.get("name") for material in arm.root.findall("link/visual/material")} <= defined


def test_no_file_names_an_absolute_path():
    for folder in ("config", "launch", "rviz", "urdf", "targets", "scripts"):
        for path in (PACKAGE / folder).iterdir():
            if path.is_file():
                text = path.read_text(errors="replace").replace("#!/usr/bin/env", "")  # pictures are bytes
                assert not re.search(r"(?:^|[\s\"'=])/(?:home|root|usr|opt|var|tmp)/", text), path.name


def test_script_makes_the_same_meshes(monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.syspath_prepend(str(PACKAGE / "scripts"))
    made = importlib.import_module("make_meshes").meshes()
    folder = PACKAGE / "meshes" / "visual"
    assert sorted(made) == sorted(path.name for path in folder.iterdir())
    assert [name for name, content in made.items() if (folder / name).read_bytes() != content] == []
