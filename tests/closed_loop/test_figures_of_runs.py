"""README.md and docs/ state the figures that runs in process make."""
import math
import pathlib
import re

import pytest

import aras_visual_servo as avs

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


def test_the_run_hash_of_the_readme_is_that_of_the_run(run):
    hashes = re.findall(r"`([0-9a-f]{16})`", (ROOT / "README.md").read_text())
    assert hashes == [run("experiment_1").run_hash]
