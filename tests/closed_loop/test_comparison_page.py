"""Some cells of docs/comparison.md are what the runs make now, on the free camera and on the arm."""
import pathlib

import pytest

from aras_visual_servo_controller.compare.laws import load_comparison, run_comparison

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAWS, TASKS = ("points_mean", "pbvs"), ("turn_90", "retreat", "general")
#: Of the final error: below it, pixels and the stop rule decide. Of the detour, which is shown in whole millimetres.
ERROR_MM, DETOUR_MM, SHARE = 0.4, 2.0, 0.1


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
