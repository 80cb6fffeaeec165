"""CONVERGED means that the camera has arrived: forty of the runs of `script/bench --stop-rule`, from the same draw."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/aras_visual_servo_study/bench"))
from stop_rule import draw, run_case, tally  # noqa: E402

RUNS, SEED = 40, 11
#: Of forty runs. One in a hundred is the aim (docs/sweeps.md), and two of forty come of it once in seventeen draws.
MOST_MISSED = 2


def test_no_run_converges_outside_its_judge_and_few_inside_do_not():
    rows = [run_case(case) for case in draw(RUNS, SEED)]
    count = tally(rows)["all"]
    assert count["runs"] >= RUNS - 2 and count["inside"] > RUNS // 2
    wrong = [(row["id"], row["scenario"], row["reason"]) for row in rows if row["converged"] and not row["inside"]]
    assert wrong == []
    missed = [(row["id"], row["scenario"], row["reason"]) for row in rows if row["inside"] and not row["converged"]]
    assert len(missed) <= MOST_MISSED, missed


def test_equal_seeds_draw_equal_cases_and_every_kind_of_them():
    cases = draw(RUNS, SEED)
    assert cases == draw(RUNS, SEED) and cases != draw(RUNS, SEED + 1)
    assert sum(case.scenario.startswith("experiment") for case in cases) == RUNS // 2
    for name, low, high in (("gain_factor", 0.5, 4.0), ("noise_stddev", 0.0, 5.0), ("friction_scale", 1.0, 5.0)):
        values = [getattr(case, name) for case in cases]
        assert low <= min(values) < low + 0.1 * (high - low) and high - 0.1 * (high - low) < max(values) <= high, name


def test_friction_of_the_wrist_leaves_no_error_and_the_arm_at_rest(run):
    record = run("experiment_1")
    rows = record.servo_rows
    alpha = record.e[rows[-2], record.feature_names.index("alpha")]
    assert abs(alpha) < 0.00006  # without compensation it is the creep over the gain, 0.12 mrad (docs/theory.md T62)
    at_rest = record.q[rows[-1] + 1:] if rows[-1] + 1 < len(record) else record.q[rows[-4:]]
    assert np.abs(np.diff(at_rest, axis=0)).max() < 0.0005
