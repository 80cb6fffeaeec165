"""Pictures of README.md and docs/: the arm seen from outside, the six panels of the published experiments, two runs as
animated pictures, the curves of the tutorial, the laws on the canonical tasks."""
import os
import pathlib
import shutil
import sys
import tempfile

import cv2

import animation
import comparison as tables
import tutorial

import aras_visual_servo as avs
from aras_visual_servo_study.compare.laws import load_comparison, run_comparison
from aras_visual_servo_study.compare.laws_report import make_figure, part_of, save_figure
from aras_visual_servo_study.report.observer import Observer
from aras_visual_servo_study.report.report import save_results
from aras_visual_servo import load_scenario

#: Laws and tasks of the README's figure, which is read at a glance; docs/comparison.md shows all.
LAWS = ("points", "points_goal", "points_mean", "pbvs", "hybrid")
TASKS = ("turn_90", "turn_180", "general")


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("experiment_1", "experiment_1_paper", "experiment_2"):
        record = avs.run(load_scenario(name))
        with tempfile.TemporaryDirectory() as results:
            save_results(record, pathlib.Path(results))
            shutil.copy(pathlib.Path(results) / "figure.png", folder / f"{name}.png")
        if name == "experiment_1":
            start = Observer(record, width=960, height=720).picture(record.q[record.servo_rows[0]])
            cv2.imwrite(str(folder / "arm.png"), cv2.cvtColor(start, cv2.COLOR_RGB2BGR))
    for name in animation.SCENARIOS:
        animation.animate(name, folder / f"{name}.webp")
    tutorial.save_picture(folder / "tutorial.png")
    page = folder.parent / "comparison.md"
    for table, scenario in tables.TABLES.items():
        comparison = load_comparison("canonical", scenario=scenario)
        results = run_comparison(comparison, workers=os.cpu_count() or 1)
        page.write_text(tables.write(page.read_text(), table, results))
    with tempfile.TemporaryDirectory() as pictures:
        save_figure(comparison, results, pathlib.Path(pictures))
        shutil.copy(pathlib.Path(pictures) / "comparison.png", folder / "comparison_all.png")
    glance = make_figure(*part_of(comparison, results, LAWS, TASKS), width_in=8.8, row_in=2.0)
    glance.savefig(folder / "comparison.png", dpi=150, metadata={"Software": None})
    print("\n".join(sorted(str(path) for path in folder.iterdir())))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
