"""What a browser draws (URDF tree, meshes, scene), and when the servo begins again for a target that moved."""

import io

import PIL.Image
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from aras_visual_servo import load_scenario, ModelError, resolve_uri, Status
from aras_visual_servo.spatial import rotation_rpy
from aras_visual_servo_study.live.following import FOLLOWED, Following
from aras_visual_servo_study.live.hub import jpeg
from aras_visual_servo_study.live.view.robot import as_block, mesh_block, STEPS, triangles_of
from aras_visual_servo_study.live.view.robot import mesh_blocks, robot_of
from aras_visual_servo_study.live.view.scene import pose_numbers, scene_of

LINK = "package://aras_description/meshes/visual/link3.stl"


def read(block):
    """(vertices (n, 3), triangles (m, 3)) of a block, as web/lib/meshes.js reads it."""
    vertices, triangles = np.frombuffer(block, "<u4", 2)
    low, step = np.frombuffer(block, "<f4", 6, 8).reshape(2, 3)
    cells = np.frombuffer(block, "<u2", 3 * vertices, 32).reshape(-1, 3)
    at = 32 + 6 * int(vertices) + (-6 * int(vertices) % 4)
    return low + step * cells, np.frombuffer(block, "<u4", 3 * triangles, at).reshape(-1, 3)


def test_a_block_holds_the_mesh_to_its_step():
    path = resolve_uri(LINK)
    corners, (vertices, triangles) = triangles_of(path), read(mesh_block(str(path)))
    step = np.ptp(corners.reshape(-1, 3), axis=0) / STEPS
    # Rounding to a step, and single precision of the box.
    assert np.abs(vertices[triangles] - corners).max() <= 0.51 * step.max() + 1e-7
    assert len(vertices) < len(triangles) and len(mesh_block(str(path))) < path.stat().st_size / 2


def test_triangles_without_area_are_left_out():
    _, triangles = read(as_block([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 0, 0], [1, 1, 1]]]))
    assert len(triangles) == 1


def test_meshes_in_text_are_read_too(tmp_path):
    (tmp_path / "a.stl").write_text("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                    "vertex 0 1 0\nendloop\nendfacet\nendsolid\n")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 4/4\n")
    assert triangles_of(tmp_path / "a.stl").tolist() == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]
    assert len(triangles_of(tmp_path / "a.obj")) == 2


DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 100 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>0 0 300</translate><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def test_a_collada_file_is_read_with_its_unit_and_its_places(tmp_path):
    (tmp_path / "a.dae").write_text(DAE)
    np.testing.assert_allclose(triangles_of(tmp_path / "a.dae"), [[[0, 0, 3], [1, 0, 3], [0, 1, 3]]], atol=1e-6)
    vertices, triangles = read(mesh_block(str(tmp_path / "a.dae")))
    np.testing.assert_allclose(vertices[triangles].max(axis=(0, 1)), [1.0, 1.0, 3.0], atol=1e-4)


@pytest.mark.parametrize("name, content, said", [
    ("a.txt", b"no mesh", "a.txt"), ("a.stl", b"solid\nvertex 1 2 x", "a.stl"), ("b.stl", b"", "b.stl"),
    ("gone.dae", None, "gone.dae")])
def test_a_mesh_that_cannot_be_drawn_is_named(tmp_path, name, content, said):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(ModelError, match=said):
        triangles_of(tmp_path / name)


def test_the_robot_is_a_tree_with_every_mesh_of_its_urdf():
    scenario = load_scenario("experiment_1")
    robot = robot_of(scenario.urdf_xml())
    blocks, notes = mesh_blocks(robot)
    assert robot["root"] == "world" and notes == [] and set(blocks) == set(robot["meshes"])
    drawn = {visual["mesh"] for visuals in robot["links"].values() for visual in visuals if "mesh" in visual}
    assert drawn == set(blocks) and len(drawn) > 10
    gantry = next(joint for joint in robot["joints"] if joint["name"] == "gantry")
    assert gantry["type"] == "prismatic" and (gantry["lower"], gantry["upper"]) == (-1.5, 1.5)
    assert sum(map(len, blocks.values())) < 400_000


def test_what_is_no_robot_is_refused():
    with pytest.raises(ModelError, match="not XML"):
        robot_of("<robot")
    with pytest.raises(ModelError, match="root links a, b"):
        robot_of('<robot><link name="a"/><link name="b"/></robot>')


def test_the_scene_has_outlines_and_pictures():
    model, = scene_of(load_scenario("experiment_1"))["models"]
    assert model["name"] == "target" and len(model["outlines"]) == 1 and model["pose"][2] == 0.193394
    photo = scene_of(load_scenario("six_dof_photometric"))["models"][0]
    assert photo["image"]["src"].startswith("data:image/png;base64,") and photo["image"]["size"][0] > 0.0


def test_pose_numbers_are_those_of_the_library():
    random = np.random.default_rng(3)
    for rotation in [*Rotation.random(50, random_state=4).as_matrix(), np.diag([1.0, -1.0, -1.0]),
                     np.diag([-1.0, 1.0, -1.0]), np.diag([-1.0, -1.0, 1.0]), np.eye(3)]:
        X = np.eye(4)
        X[:3, :3], X[:3, 3] = rotation, random.normal(size=3)
        numbers = pose_numbers(X)
        assert Rotation.from_quat(numbers[3:]).as_matrix() == pytest.approx(rotation, abs=5e-6)
        assert numbers[:3] == pytest.approx(X[:3, 3], abs=1e-6)


@pytest.mark.parametrize("encoding", ("rgb8", "mono8", "mono16", "rgb16"))
def test_a_jpeg_has_the_colours_of_the_image(encoding):
    colours = np.array([[[250, 20, 20], [20, 250, 20]], [[20, 20, 250], [128, 128, 128]]], dtype=np.uint8)
    image = np.kron(colours, np.ones((16, 16, 1), np.uint8))
    deep = image * np.uint16(257)
    sent = {"rgb8": image, "mono8": image[:, :, 0], "mono16": deep[:, :, 0], "rgb16": deep}[encoding]
    shown = np.asarray(PIL.Image.open(io.BytesIO(jpeg(sent))))
    error = np.abs(shown.astype(int) - (image[:, :, 0] if "mono" in encoding else image))
    # Loss of the compression. Colours are kept for 2 x 2 pixels each and blurred over the next.
    assert max(error[i:i + 8, j:j + 8].max() for i in (4, 20) for j in (4, 20)) <= 6


REST = np.eye(4)


def moved(way_m=0.01, turn=0.0):
    X_WT = np.eye(4)
    X_WT[:3, :3], X_WT[1, 3] = rotation_rpy((0.0, 0.0, turn)), way_m
    return X_WT


def ended(status, before=REST, last=REST):
    """One that has seen a servo begin at a place of the target and end at another."""
    following = Following()
    assert not following.answered("settle_start", Status.IDLE, moved(0.5), True)
    for X_WT in (before, last):
        assert not following.answered("servo", Status.SERVOING, X_WT, True)
    again = following.answered("done", status, last, True)
    return again, following


@pytest.mark.parametrize("status", [status for status in Status if status != Status.SERVOING])
def test_a_target_that_moves_afterwards_is_followed_where_the_servo_had_found_it(status):
    again, following = ended(status)
    assert not again and not following.answered("done", status, REST, True)
    assert following.answered("done", status, moved(), True) == (status in FOLLOWED)


@pytest.mark.parametrize("X_WT, again", [(moved(1.9e-4), False), (moved(2.1e-4), True), (moved(-2.1e-4), True),
                                         (moved(0.0, 0.9e-3), False), (moved(0.0, 1.1e-3), True),
                                         (moved(0.0, -1.1e-3), True)])
def test_how_far_it_has_to_move_or_turn(X_WT, again):
    _, following = ended(Status.CONVERGED)
    assert following.answered("done", Status.CONVERGED, X_WT, True) == again


def test_it_is_said_once_for_each_place():
    _, following = ended(Status.CONVERGED)
    assert following.answered("done", Status.CONVERGED, moved(0.01), True)
    assert not following.answered("done", Status.CONVERGED, moved(0.01), True)
    assert following.answered("done", Status.CONVERGED, moved(0.02), True)


def test_one_that_moved_while_it_was_not_followed_is_followed_from_then_on():
    _, following = ended(Status.CONVERGED)
    assert not following.answered("done", Status.CONVERGED, moved(), False)
    assert following.answered("done", Status.CONVERGED, moved(), True)


def test_after_a_servo_whose_time_was_up_it_counts_where_the_target_was_when_the_servo_began():
    assert ended(Status.TIMED_OUT, last=moved())[0] and not ended(Status.CONVERGED, last=moved())[0]
    assert not ended(Status.TIMED_OUT, before=moved(), last=moved())[0]
    _, following = ended(Status.TIMED_OUT, last=moved())
    # The next servo begins where the target rests by now: its end is the end.
    assert not following.answered("servo", Status.SERVOING, moved(), True)
    assert not following.answered("done", Status.TIMED_OUT, moved(), True)


def test_a_view_that_is_taught_is_one_that_need_not_be_followed():
    _, following = ended(Status.CONVERGED)
    assert not following.answered("done", Status.CONVERGED, moved(), False)
    following.taught()
    assert not following.answered("done", Status.CONVERGED, moved(), True)
    assert following.answered("done", Status.CONVERGED, moved(0.02), True)
