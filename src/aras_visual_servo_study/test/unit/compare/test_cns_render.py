"""Protocol `cns_render`: things of our own, where they came to rest, poses within the published ranges, and a run."""

import numpy as np
import pytest

from aras_visual_servo import load_yaml, ParameterError
from aras_visual_servo.spatial import quaternion_xyzw, rotation_rpy
from aras_visual_servo_study.compare.protocols import board as boards, cns_render, protocol_named, settled

STILL_M, STILL_S = 1e-3, 0.3


def vertices_and_faces(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices = np.array([line[1:] for line in lines if line[0] == "v"], float)
    normals = np.array([line[1:] for line in lines if line[0] == "vn"], float)
    faces = np.array([[word.split("/") for word in line[1:]] for line in lines if line[0] == "f"], int) - 1
    return vertices, normals, faces


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    return settled.save_props(tmp_path_factory.mktemp("props"))


def test_both_poses_of_a_scene_are_within_the_published_ranges():
    goals, starts = cns_render.pairs()
    assert len(goals) == len(starts) == 150
    for poses in goals, starts:
        distance = np.linalg.norm(poses[:, :3, 3], axis=1)
        assert 0.5 <= distance.min() < 0.52 and 0.88 < distance.max() <= 0.9
        assert np.degrees(np.arcsin(poses[:, 2, 3] / distance)).min() >= 70.0
        towards = -poses[:, :3, 3] / distance[:, None]
        assert np.degrees(np.arccos(np.sum(towards * poses[:, :3, 2], axis=1))).max() < 7.2
    few = cns_render.pairs(3)[0]
    np.testing.assert_array_equal(few, goals[[0, 74, 149]])


def test_a_thing_is_closed_with_its_sides_outward_and_painted(meshes):
    assert sorted(meshes) == sorted(prop.name for prop in settled.PROPS)
    for prop in settled.PROPS:
        vertices, normals, faces = vertices_and_faces(meshes[prop.name])
        a, b, c = (vertices[faces[:, k, 0]] for k in range(3))
        x, y = prop.corners.T
        area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        volume = np.sum(np.sum(a * np.cross(b, c), axis=1)) / 6.0
        assert volume == pytest.approx(area * prop.height_m, rel=1e-4)
        outward = np.cross(b - a, c - a)
        np.testing.assert_allclose(normals[faces[:, 0, 2]],
                                   outward / np.linalg.norm(outward, axis=1)[:, None], atol=1e-4)
        picture = boards.load(meshes[prop.name].with_suffix(".png"))
        assert picture.astype(float).std() > 40.0


def test_the_record_has_150_scenes_of_our_things():
    scenes = settled.load_scenes(cns_render.RECORD)
    assert sorted(scenes) == list(range(1, 151))
    assert {len(things) for things in scenes.values()} == {8, 9, 10, 11}
    assert {one.thing for things in scenes.values() for one in things} == {prop.name for prop in settled.PROPS}


@pytest.mark.parametrize("number", (1, 76, 150))
def test_recorded_things_are_at_rest(meshes, number):
    pytest.importorskip("aras_visual_servo_sim")
    sim, places = settled.table(), {}
    for k, one in enumerate(settled.load_scenes(cns_render.RECORD)[number]):
        name = f"thing_{k + 1}"
        sim.spawn_model({"name": name, "mesh": str(meshes[one.thing]), "mass_kg": settled.MASS_KG, "touches": "all",
                         "position_m": list(one.position_m), "rpy_rad": list(one.rpy_rad)})
        places[name] = one
    sim.step(round(STILL_S * 1e9 / sim.period_ns))
    for name, one in places.items():
        X_WM = sim.model_pose(name)
        assert np.linalg.norm(X_WM[:3, 3] - one.position_m) < STILL_M, one
        turned = abs(quaternion_xyzw(X_WM[:3, :3]) @ quaternion_xyzw(rotation_rpy(one.rpy_rad)))
        assert turned > np.cos(0.5 * np.radians(2.0)), one


def test_things_that_are_dropped_again_lie_where_they_lay(meshes, tmp_path):
    pytest.importorskip("aras_visual_servo_sim")
    things = settled.settle(meshes, 5, count=4)
    assert things == settled.settle(meshes, 5, count=4) != settled.settle(meshes, 6, count=4)
    assert len(things) == 4 and all(0.0 < one.position_m[2] < 0.2 for one in things)
    settled.save_scenes(tmp_path / "scenes.csv", {5: things})
    assert settled.load_scenes(tmp_path / "scenes.csv") == {5: things}
    (tmp_path / "other.csv").write_text("scene,x\n1,2\n")
    with pytest.raises(ParameterError, match="other.csv: found columns .* allowed scene, thing"):
        settled.load_scenes(tmp_path / "other.csv")


def test_a_start_has_its_scene_and_the_depth_of_its_table(tmp_path):
    case = protocol_named("cns_render").cases(tmp_path, 3)[1]
    assert case.name == "akaze" and case.published[0] == 1.0 and [start.id for start in case.starts] == [1, 75, 150]
    goal, start = cns_render.pairs(3)[0][1], case.starts[1]
    axis = goal[:3, 3] + start.parameters["experiment.z_star_m"] * goal[:3, 2]
    assert abs(axis[2]) < 1e-12
    np.testing.assert_allclose(goal[:3, :3] @ start.goal["target_normal_C"], [0.0, 0.0, -1.0], atol=1e-12)
    solids = load_yaml(start.parameters["scene"])["solids"]
    recorded = settled.load_scenes(cns_render.RECORD)[75]
    assert [solid["position_m"] for solid in solids] == [list(one.position_m) for one in recorded]


def test_a_run_comes_home_to_what_was_on_the_table(tmp_path):
    pytest.importorskip("aras_visual_servo_sim")
    from aras_visual_servo_study.sweep.run import SweepRunner
    case = protocol_named("cns_render").cases(tmp_path, 1)[0]
    row, _ = SweepRunner(case.scenario).run(case.starts[0])
    assert row["cns"] == 1 and row["error_mm"] < 5.0, (row["outcome"], row["reason"], row["detail"])


def test_meshes_of_a_users_folder_are_dropped_in_place_of_ours(meshes, tmp_path):
    pytest.importorskip("aras_visual_servo_sim")
    folder = tmp_path / "mine" / "cup"
    folder.mkdir(parents=True)
    for name in ("cup.obj", "cup_collision.obj", "notes.txt"):
        (folder / name).write_text(meshes["box_cube"].read_text())
    assert list(settled.meshes_in(tmp_path / "mine")) == ["cup/cup.obj"]
    case = protocol_named("cns_render").cases(tmp_path / "files", 1, meshes=str(tmp_path / "mine"))[0]
    solids = load_yaml(case.starts[0].parameters["scene"])["solids"]
    assert {solid["mesh"] for solid in solids} == {str((folder / "cup.obj").resolve())} and len(solids) >= 8
    with pytest.raises(ParameterError, match="--meshes: found .*empty, allowed a folder with meshes"):
        settled.meshes_in(tmp_path / "empty")


def test_a_protocol_refuses_what_it_has_no_use_for():
    for name, given, allowed in (("cns_render", "board", "--meshes"), ("vit_vs", "meshes", "--board"),
                                 ("latency", "board", "neither --board nor --meshes")):
        with pytest.raises(ParameterError, match=f"--{given}: found a, but the protocol {name} takes {allowed}"):
            protocol_named(name).check_own({given: "a"})
    protocol_named("vit_vs").check_own({"board": "a.png"})
