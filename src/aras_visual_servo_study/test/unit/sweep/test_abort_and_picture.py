"""Runs that are ended because the camera goes too far; pictures and clutter that come after teaching."""

import numpy as np
import pytest

from aras_visual_servo import load_scenario, ParameterError, robot_kinematics
from aras_visual_servo.spatial import exponential
from aras_visual_servo_study.sweep.perturb import put_clutter, read_perturbations, swap_picture
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.run import SweepRunner

PICTURE, OTHER_PICTURE = (f"package://aras_description/targets/{name}.png" for name in ("photo", "tag"))


class Recorder:
    """What `swap_picture` and `put_clutter` ask of a Simulation."""

    def __init__(self):
        self.asked, self.lights = [], []
        self.delete_model = self.spawn_model = self.asked.append
        self.set_light = self.lights.append


def test_a_run_that_goes_too_far_is_ended():
    """A turn by 90 degrees and 5 mm: with moments the camera leaves the spot by far more than five times that."""
    pytest.importorskip("aras_visual_servo_sim")
    rows = []
    for factor in (5.0, 1000.0):
        scenario = load_scenario("free_camera", {"sweep.abort_factor": factor, "servo.time_limit_s": 1.5})
        kinematics = robot_kinematics(scenario.urdf_xml(), "world", "camera_optical_frame")
        goal = kinematics.pose(scenario.goal_posture(kinematics))
        away = goal @ exponential(np.array([0.005, 0.0, 0.0, 0.0, 0.0, 0.5 * np.pi]))
        rows.append(SweepRunner(scenario).run(Start(1, kinematics.by_name(kinematics.coordinates(away))))[0])
    ended, gone_on = rows
    assert ended["detail"] == "farther than 5 times the start" and ended["outcome"] == "failure"
    assert ended["error_mm"] > 5.0 * ended["distance0_mm"] and ended["images"] < gone_on["images"]
    assert "farther" not in gone_on["detail"]


def test_the_picture_of_the_target_is_replaced_and_the_rest_of_it_kept():
    scenario, sim = load_scenario("six_dof_photometric"), Recorder()
    swap_picture(sim, scenario, PICTURE)
    name, entry = sim.asked
    model = scenario.sim["scene"]["models"][0]
    assert name == entry["name"] == model["name"] and entry["position_m"] == model["position_m"]
    assert entry["image"]["size_m"] == model["image"]["size_m"] and entry["image"]["file"].endswith("/photo.png")
    with pytest.raises(ParameterError, match="no model with a picture"):
        swap_picture(sim, load_scenario("experiment_1"), PICTURE)


def test_what_a_run_does_to_the_scene_is_undone_before_the_next_one(tmp_path):
    """A picture and solids that come after teaching, solids that are there before, and nothing, in any order."""
    pytest.importorskip("aras_visual_servo_sim")
    box, scenario = tmp_path / "box.yaml", load_scenario("six_dof_photometric", {"servo.time_limit_s": 0.2})
    box.write_text("solids: [{name: box, box_m: [0.03, 0.03, 0.03], position_m: [0.07, 0.06, 0.25]}]")
    joints = scenario.as_dict()["experiment"]["start"]["joints"]
    picture, clutter, scene = {"picture": OTHER_PICTURE}, {"clutter": str(box)}, {"scene": str(box)}
    kinds = [{}, picture, {}, {}, clutter, {}, scene, scene, {}]
    bench = SweepRunner(scenario)
    rows = [bench.run(Start(1, joints, parameters=kind))[0] for kind in kinds]
    fresh = {str(kind): SweepRunner(scenario).run(Start(1, joints, parameters=kind))[0] for kind in kinds}
    assert rows == [fresh[str(kind)] for kind in kinds]
    assert {row["outcome"] for row in rows} <= {"success", "failure"}, rows
    assert len({row["run_hash"] for row in rows}) == 4


def test_a_picture_that_is_no_file_is_refused_before_the_sweep():
    scenario = load_scenario("six_dof_photometric")
    assert read_perturbations({"picture": {"values": [PICTURE]}}, scenario)[0].name == "picture"
    with pytest.raises(ParameterError, match="sweep.perturb.picture: .*no such file"):
        read_perturbations({"picture": {"values": ["/nowhere.png"]}}, scenario)


@pytest.mark.parametrize("text, solids, lights", [
    ("solids: [{name: a}, {name: b}]", ["a", "b"], []), ("lights: [{name: key}, {name: fill}]", [], ["key", "fill"]),
    ("{solids: [{name: a}], lights: [{name: key}]}", ["a"], ["key"])])
def test_clutter_puts_every_solid_and_light_of_its_file_into_the_scene(tmp_path, text, solids, lights):
    (tmp_path / "clutter.yaml").write_text(text)
    scenario, sim = load_scenario("experiment_1"), Recorder()
    put_clutter(sim, scenario, str(tmp_path / "clutter.yaml"))
    assert [one["name"] for one in sim.asked] == solids and [one["name"] for one in sim.lights] == lights
