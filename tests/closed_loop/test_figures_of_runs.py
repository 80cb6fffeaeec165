"""README.md and docs/ state the figures that runs in process make."""

import importlib
import math
import pathlib
import re
import sys

import numpy as np
import pytest
from release import of_debian_12

import aras_visual_servo as avs
from aras_visual_servo_study.compare.laws import load_comparison, run_comparison
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.run import SweepRunner

ROOT = pathlib.Path(__file__).resolve().parents[2]
AXES = ("x_mm", "y_mm", "z_mm")
#: Other compilers and processors round otherwise: half of the last digit that a page shows, and this part of a figure.
SHARE = 0.05
#: (page, pattern of the sentence, scenario, figures in it)
SENTENCES = [
    *(("docs/features_and_laws.md", rf"`{name}` .*? \| (\S+), (\S+), (\S+); (\S+) \| (\S+) s", name,
       (*AXES, "angle_deg", "duration_s"))
      for name in ("six_dof_points", "six_dof_hybrid", "six_dof_rgbd", "six_dof_sliding", "six_dof_broyden")),
    ("docs/extending.md", r"arrives after (\S+) s within (\S+) mm and (\S+) deg", "six_axis_flange",
     ("duration_s", "error_mm", "angle_deg")),
    ("src/aras_visual_servo/README.md", r"comes to rest (\S+) mm and (\S+) deg from the goal",
     "naive_inverse", ("error_mm", "angle_deg")),
    ("src/aras_visual_servo/README.md", r"arrives within (\S+) mm and (\S+) deg", "redundant",
     ("error_mm", "angle_deg")),
]


def figures_of(record: avs.RunRecord) -> dict:
    """Returns the final error of a run, without signs [mm, deg], and its duration [s]."""
    result = avs.judge(record)
    error = {name: abs(value) for name, value in result.final_error.items()}
    return {**error, "error_mm": math.hypot(*(error[axis] for axis in AXES)), "duration_s": result.duration_s}


@pytest.mark.parametrize("page, sentence, scenario, names", SENTENCES, ids=[entry[2] for entry in SENTENCES])
def test_a_page_states_what_a_run_makes(run, page, sentence, scenario, names):
    stated = re.search(sentence, (ROOT / page).read_text()).groups()
    made = figures_of(run(scenario))
    for name, text in zip(names, stated, strict=True):
        half = 0.5 * 10.0 ** -len(text.partition(".")[2])
        assert made[name] == pytest.approx(float(text), rel=SHARE, abs=half), f"{page}, {scenario}: {name}"


@of_debian_12
def test_the_run_hash_of_the_readme_is_that_of_the_run(run):
    hashes = re.findall(r"`([0-9a-f]{16})`", (ROOT / "README.md").read_text())
    assert hashes == [run("experiment_1").run_hash]


LAWS, TASKS = ("points_mean", "pbvs"), ("turn_90", "retreat", "general")
#: Of the final error: below it, pixels and the stop rule decide. Of the detour, which is shown in whole millimetres.
ERROR_MM, DETOUR_MM, DETOUR_SHARE = 0.4, 2.0, 0.1
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
        same = ended == ended_said and abs(detour - detour_said) <= DETOUR_MM + DETOUR_SHARE * detour_said
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
    told = np.isin(status, (avs.Status.NEAR_SINGULARITY, avs.Status.OUT_OF_REACH))
    assert told.mean() >= 0.1 * LEAST_OF_TEN


WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
# A median, or the worst of 16 runs. Another build or processor rounds otherwise, and a pixel more or less on the edge
# of the object changes one of them by this much.
PAPER_SHARE, LEAST = 0.2, 0.02


def rows(lines):
    """Row -> its numbers, of the lines of a table about experiments."""
    found = {}
    for line in lines:
        if line.startswith("| experiment"):
            name, _, cells = line.strip("| ").partition(" |")
            found[name] = [float(number) for number in re.findall(r"\d+(?:\.\d+)?", cells)]
    return found


@of_debian_12
def test_the_table_of_the_readme_is_the_one_measured(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(WORKSPACE / "script/pictures"), *sys.path])
    lines, _ = importlib.import_module("paper_table").table()
    page = (WORKSPACE / "docs" / "performance.md").read_text(encoding="utf-8")
    measured, written = rows(lines), rows(page.splitlines())
    assert len(measured) == 6 and list(written) == list(measured)
    for name, numbers in measured.items():
        assert len(written[name]) == len(numbers), name
        for here, there in zip(numbers, written[name]):
            assert abs(here - there) <= max(PAPER_SHARE * here, LEAST), f"{name}: found {there}, measured {here}"
