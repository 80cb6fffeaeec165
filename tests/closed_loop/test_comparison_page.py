"""Some cells of docs/comparison.md are what the runs make now, on the free camera and on the arm."""
import pathlib

import pytest

import aras_visual_servo as avs
from aras_visual_servo_study.compare.laws import load_comparison, run_comparison
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.run import SweepRunner

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAWS, TASKS = ("points_mean", "pbvs"), ("turn_90", "retreat", "general")
#: Of the final error: below it, pixels and the stop rule decide. Of the detour, which is shown in whole millimetres.
ERROR_MM, DETOUR_MM, SHARE = 0.4, 2.0, 0.1
#: How near to the lowest place of a run [mm], and of how many images there at least, in ten, the status is asked for.
NEAR_MM, LEAST_OF_TEN = 8, 9


@pytest.mark.parametrize("table, scenario", [("free_camera", "free_camera"), ("arm", None)])
def test_the_page_states_what_runs_make(docs, table, scenario):
    tables = docs("comparison")
    stated = tables.read((ROOT / "docs" / "comparison.md").read_text(), table)
    off = []
    for task, law, row, _ in run_comparison(load_comparison("canonical", LAWS, TASKS, scenario=scenario), workers=0):
        found, said = tables.cell(row), stated[law, task]
        (error, ended, detour), (error_said, ended_said, detour_said) = tables.numbers(found), tables.numbers(said)
        same = ended == ended_said and abs(detour - detour_said) <= DETOUR_MM + SHARE * detour_said
        if not same or (error is not None and abs(error - error_said) > ERROR_MM):
            off.append(f"{law}, {task}: the page says {said}, found {found}")
    assert not off, "\n".join([*off, "script/gallery makes the tables again"])


def test_a_table_is_read_as_it_was_written(docs):
    tables = docs("comparison")
    row = {"outcome": "success", "reason": "converged", "converged": 1, "error_mm": 0.123, "angle_deg": 0.1,
           "detour_mm": 4.4}
    lost = {**row, "outcome": "failure", "reason": "timed out, at a joint limit", "converged": 0, "error_mm": 90.0}
    results = [("turn_90", "a", row, None), ("turn_90", "b", lost, None), ("general", "a", lost, None),
               ("general", "b", row, None)]
    page = tables.write(tables.BEGIN.format("arm") + tables.END + "\n", "arm", results)
    assert tables.read(page, "arm") == {
        ("a", "turn_90"): "0.12; 4", ("b", "turn_90"): "**timed out, at a joint limit**; 4",
        ("a", "general"): "**timed out, at a joint limit**; 4", ("b", "general"): "0.12; 4"}


@pytest.mark.parametrize("task", ["turn_90", "turn_135"])
def test_where_the_reach_ends_the_status_says_so(task):
    """Where the arm ends, its elbow is stretched and goes to and fro."""
    comparison = load_comparison("canonical", ["points_goal"], [task])
    scenario = comparison.scenarios["points_goal"]
    kinematics = avs.robot_kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    goal = scenario.goal_posture(kinematics)
    joints, refusal = avs.reach(kinematics, goal, kinematics.pose(goal) @ comparison.tasks[0].X_CgC)
    assert not refusal, refusal
    _, record = SweepRunner(scenario).run(Start(1, joints))
    height_mm = 1e3 * record.X_WC[record.servo_rows, 2, 3]
    status = record.status[record.servo_rows][height_mm < height_mm.min() + NEAR_MM]
    assert len(status) > 100, "the arm does not stay at its lowest place"
    assert (status == avs.Status.NEAR_SINGULARITY).mean() >= 0.1 * LEAST_OF_TEN
