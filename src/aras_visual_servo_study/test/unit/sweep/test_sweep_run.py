"""One run of a sweep with the real simulator: outcomes, reuse, aborts, pictures and clutter."""

import json
import math

import numpy as np
import pytest

from aras_visual_servo import judge, load_scenario, ParameterError, robot_kinematics, ServoLoop, ServoSettings
from aras_visual_servo.spatial import exponential
from aras_visual_servo_study.report.report import save_results
from aras_visual_servo_study.sweep.judge import trace_hash
from aras_visual_servo_study.sweep.perturb import perturbed, put_clutter, read_perturbations, swap_picture
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.run import SweepRunner
from aras_visual_servo_study.sweep.worker import make_setup, run_chunk, scenario_of

GOAL = {"gantry": 0.05, "J1": 0.0, "J2": -0.09, "J3": 0.045, "J5": 0.045, "J6": 0.0}
NEAR = {**GOAL, "gantry": -0.02, "J2": 0.1, "J3": -0.05, "J6": 0.1}
FAR = {**GOAL, "gantry": -0.1, "J2": 0.34906585, "J3": -0.26179939, "J5": -0.08726646, "J6": 0.17453293}
MOVED = 1e-3   # [m, rad]: a tenth of what the first image makes the gantry move until the next
OUT_OF_VIEW = {**GOAL, "gantry": 1.2}


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("experiment_1")


@pytest.fixture(scope="module")
def bench(scenario):
    return SweepRunner(scenario)


def test_a_reset_simulator_gives_the_bytes_of_a_new_one(scenario, bench):
    first, _ = bench.run(Start(1, NEAR))
    bench.run(Start(2, FAR))
    bench.run(Start(3, NEAR, parameters={"noise_stddev": 1.0}))
    again, record = bench.run(Start(1, NEAR))
    fresh, _ = SweepRunner(scenario).run(Start(1, NEAR))
    assert first == again == fresh
    assert first["outcome"] == "success" and first["strict"] == first["cns"] == first["vit_vs"] == 1
    assert first["trace_hash"] == trace_hash(record) and len(first["run_hash"]) == 16


def test_a_goal_that_was_reached_before_is_gone_on_from_and_another_is_not_taken_for_it(scenario, monkeypatch):
    placed = []
    place = ServoLoop.place

    def counted(self, joints, settle_s=0.0):
        placed.append(dict(joints))
        place(self, joints, settle_s)

    monkeypatch.setattr(ServoLoop, "place", counted)
    other = {"joints": {**GOAL, "gantry": 0.03, "J6": 0.02}, "target_normal_C": [0.0, 0.0, 1.0]}
    starts = [Start(1, NEAR), Start(2, NEAR, goal=other), Start(3, FAR, goal=other), Start(4, NEAR)]
    shared = SweepRunner(scenario)
    rows = [shared.run(start)[0] for start in starts]
    assert placed == [GOAL, NEAR, other["joints"], NEAR, FAR, GOAL, NEAR]
    assert rows == [SweepRunner(scenario).run(start)[0] for start in starts]
    assert rows[0]["run_hash"] == rows[3]["run_hash"] != rows[1]["run_hash"]
    assert {row["outcome"] for row in rows} == {"success"}


def test_what_runs_share_is_read_once_and_what_differs_is_read(scenario, monkeypatch):
    read, from_dict = [], ServoSettings.from_dict
    monkeypatch.setattr(ServoSettings, "from_dict",
                        lambda config, names: read.append(config) or from_dict(config, names))
    gains = {"servo.gains_per_s.xn": 1.0}
    starts = [Start(1, NEAR), Start(2, FAR), Start(3, NEAR, parameters=gains), Start(4, NEAR), Start(5, FAR),
              Start(6, NEAR, parameters={"friction_scale": 1.5}), Start(7, NEAR, parameters={"friction_scale": 1.5})]
    shared = SweepRunner(scenario)
    rows = [shared.run(start)[0] for start in starts]
    # Once with the simulator, then where the section or the robot is another than in the run before.
    assert [config["gains_per_s"]["xn"] for config in read] == [3.0, 1.0, 3.0, 3.0]
    assert rows == [SweepRunner(scenario).run(start)[0] for start in starts]
    assert rows[0]["duration_s"] < rows[2]["duration_s"] and rows[3] == dict(rows[0], id=4)
    assert rows[0]["border_px"] != rows[1]["border_px"]


def test_images_of_the_time_before_a_goal_that_is_gone_on_from_are_not_looked_at(scenario):
    bench, late = SweepRunner(scenario), {"latency_s": 0.1, "servo.time_limit_s": 0.5}
    first, again = (bench.run(Start(1, NEAR, parameters=late)) for _ in range(2))
    assert first[0] == again[0] and first[0]["outcome"] == "failure"
    assert again[1].stamp_ns[0] >= 1e9 * bench.scenario.experiment["settle_s"]


def test_driven_runs_give_the_trace_of_a_whole_experiment(scenario):
    row, record = SweepRunner(scenario, drive_to_start=True).run(Start(1, dict(scenario.experiment["start"]["joints"])))
    whole = ServoLoop(scenario).run(closing_s=0.0)
    assert row["run_hash"] == whole.run_hash and row["trace_hash"] == trace_hash(whole)


def test_a_target_that_moves_is_where_the_goal_is_as_in_a_whole_experiment():
    scenario = load_scenario("moving_target", {"servo.time_limit_s": 4.0})
    start = Start(1, scenario.as_dict()["experiment"]["start"]["joints"])
    driven, _ = SweepRunner(scenario, drive_to_start=True).run(start)
    whole = judge(ServoLoop(scenario).run()).final_error
    assert {key: driven[key] for key in whole} == whole
    placed, record = SweepRunner(scenario).run(start)
    assert placed["error_mm"] < 3.0 * driven["error_mm"] and record.target_poses is not None


def test_a_target_out_of_view_at_the_start_is_infeasible_not_a_failure(bench):
    row, record = bench.run(Start(4, OUT_OF_VIEW))
    assert (row["outcome"], row["reason"], record) == ("infeasible", "target not in view at the start", None)
    assert row["distance0_mm"] == pytest.approx(1150.0, abs=1.0)


def test_a_refused_start_is_a_row_that_says_why(bench):
    row, _ = bench.run(Start(5, None, refusal="camera pose out of reach: 3 mm and 0 deg are missing"))
    assert (row["outcome"], row["reason"]) == ("infeasible", "camera pose out of reach")
    assert "3 mm" in row["detail"] and row["run_hash"] is None


def test_a_run_that_raises_is_a_row_with_its_reason(bench, monkeypatch):
    def broken(self, *_):
        raise ZeroDivisionError("made up")
    monkeypatch.setattr(ServoLoop, "step", broken)
    row, record = bench.run(Start(6, NEAR))
    assert (row["outcome"], row["reason"], row["detail"]) == ("error", "error: ZeroDivisionError", "made up")
    assert record is None and row["success"] == 0


def test_a_short_time_limit_is_a_failure_that_timed_out(bench):
    row, _ = bench.run(Start(7, FAR, parameters={"servo.time_limit_s": 0.3}))
    assert (row["outcome"], row["reason"], row["converged"]) == ("failure", "timed out", 0)
    assert row["error_mm"] > 0.1 * row["distance0_mm"]


def test_noise_is_seeded_by_the_run_and_repeats(bench):
    noise = {"noise_stddev": 2.0, "servo.time_limit_s": 0.5, "friction_scale": 1.5}
    hashes = [bench.run(Start(number, NEAR, parameters=noise))[0]["run_hash"] for number in (8, 9, 8)]
    assert hashes[0] == hashes[2] != hashes[1]


@pytest.mark.parametrize("name, value", [("friction_scale", 2.0), ("pid_gain_scale", 0.5), ("damping_scale", 3.0),
                                         ("z_star_error", 0.2), ("target", "l_shape"), ("target_scale", 0.8),
                                         ("focal_error", 0.05), ("principal_point_error_px", 2.0),
                                         ("latency_images", 2)])
def test_every_perturbation_changes_the_run(bench, name, value):
    limit = {"servo.time_limit_s": 0.3}
    plain, _ = bench.run(Start(10, NEAR, parameters=limit))
    changed, _ = bench.run(Start(10, NEAR, parameters={**limit, name: value}))
    assert changed["outcome"] in ("success", "failure"), changed["detail"]
    assert changed["trace_hash"] != plain["trace_hash"]


def test_an_answer_that_comes_late_moves_the_arm_that_many_images_later(bench):
    limit = {"servo.time_limit_s": 0.5}
    first = {}
    for latency in (0, 3):
        record = bench.run(Start(11, NEAR, parameters={**limit, "latency_images": latency}))[1]
        q = record.q[record.servo_rows]
        first[latency] = next(i for i, row in enumerate(q) if np.abs(row - q[0]).max() > MOVED)
    assert first[3] == first[0] + 3


def test_a_wrong_calibration_is_believed_but_the_images_are_the_same(bench, scenario):
    believed = perturbed(scenario, {"focal_error": 0.1, "principal_point_error_px": -2.0}).believed_camera_info(
        {"K": [200.0, 0, 160.0, 0, 200.0, 120.0, 0, 0, 1], "P": [200.0, 0, 160.0, 0, 0, 200.0, 120.0, 0, 0, 0, 1, 0]})
    assert believed["K"] == pytest.approx([220.0, 0, 158.0, 0, 220.0, 118.0, 0, 0, 1])
    assert believed["P"] == pytest.approx([220.0, 0, 158.0, 0, 0, 220.0, 118.0, 0, 0, 0, 1, 0])
    plain, wrong = (bench.run(Start(12, NEAR, parameters=p))[1] for p in ({}, {"focal_error": 0.1}))
    row = plain.servo_rows[0]
    # x_g is what the moments say in normalised coordinates: the same pixels, over a focal length 10 % too long.
    assert wrong.raw[row, 1] == pytest.approx(plain.raw[row, 1] / 1.1, rel=1e-6)


def test_the_record_of_a_run_makes_a_whole_result_folder(bench, tmp_path):
    row, record = bench.run(Start(1, NEAR))
    summary = save_results(record, tmp_path)
    assert summary["passed"] and summary["run_hash"] == row["run_hash"]
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"summary.json", "trace.csv", "figure.png", "figure.pdf", "report.html"}
    assert any("placed" in note for note in json.loads((tmp_path / "summary.json").read_text())["notes"])


def test_workers_rebuild_the_scenario_and_refuse_other_files(scenario):
    setup = json.loads(json.dumps(make_setup(scenario, False)))
    assert scenario_of(setup).as_dict() == scenario.as_dict()
    start = {"id": 5, "joints": None, "offset": {}, "parameters": {}, "refusal": "no"}
    assert run_chunk(setup, [start])[0][0]["outcome"] == "infeasible"
    with pytest.raises(RuntimeError, match="differ from those"):
        run_chunk(dict(setup, files="0"), [start])


def test_a_refused_start_tells_from_where_it_would_have_begun(bench):
    offset = {"x_m": 0.003, "y_m": -0.004, "z_m": 0.012, "rx_rad": 0.03, "ry_rad": -0.04, "rz_rad": 0.12}
    row, _ = bench.run(Start(1, None, offset, refusal="camera pose out of reach: far"))
    assert (row["x0_mm"], row["y0_mm"], row["z0_mm"]) == pytest.approx((3.0, -4.0, 12.0))
    assert (row["distance0_mm"], row["angle0_deg"]) == pytest.approx((13.0, math.degrees(0.13)))
    row, _ = bench.run(Start(1, None, refusal="goal out of reach: far"))
    assert row["x0_mm"] is row["distance0_mm"] is row["angle0_deg"] is None


@pytest.mark.parametrize("name, where", [("clutter", "start"), ("scene", "goal")])
def test_what_stands_in_the_way_comes_before_or_after_teaching_and_for_one_run(bench, tmp_path, name, where):
    (tmp_path / "cover.yaml").write_text("solids: [{name: cover, box_m: [2.0, 2.0, 0.01], color_rgb: [230, 230, 230], "
                                         "position_m: [0.0, 0.0, 0.25]}]")
    row, _ = bench.run(Start(13, NEAR, parameters={name: str(tmp_path / "cover.yaml")}))
    assert (row["outcome"], row["reason"]) == ("infeasible", f"target not in view at the {where}")
    assert bench.run(Start(1, NEAR))[0]["outcome"] == "success"


def test_a_servo_that_does_not_end_is_given_up(bench, monkeypatch):
    monkeypatch.setattr("aras_visual_servo_study.sweep.run.DEFAULT_LIMIT_S", 1.5)
    row, record = bench.run(Start(14, FAR))
    assert record is None and (row["outcome"], row["reason"]) == ("error", "error: ArasError")
    assert row["detail"].startswith("given up after 1.5 s of simulated time in phase ")


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
