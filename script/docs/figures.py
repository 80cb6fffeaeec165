"""Figures of README.md and docs/: docs/figures.yaml says what they are, what makes them and where they stand.

    figures:                       # by name
      six_dof_points.x_mm: {value: 0.06, made_by: run, tolerance: 0.02}
      loop: {value: 113, made_by: 'script/bench: whole loop in process, simulated / wall seconds, one core'}
    texts:                         # word for word, {name:format} stands for a figure, lines may break anywhere
    - {file: README.md, text: 'at {loop:.0f} times real time'}

`made_by: run`: the name is SCENARIO.KEY, KEY one of RUN_KEYS. These are the same on every machine, but for rounding,
and a test makes them again (tests/closed_loop/test_figures_of_runs.py). `script/bench: ROW` is a row of what
script/bench prints. Anything else is a command that a person runs. Timings are held only to be the same here and in
the text.
Formats are those of Python, and `t`: a whole number of three digits and noughts, thousands apart.
"""
import argparse
import json
import pathlib
import re

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = ROOT / "docs" / "figures.yaml"
HEADER = ("# Figures of README.md and docs/, what makes them, and the texts that state them. `script/figures` renews\n"
          "# this file and the texts; script/docs/figures.py says how to read it.\n")
RUN_KEYS = ("x_mm", "y_mm", "z_mm", "angle_deg", "duration_s", "x0_mm", "y0_mm", "z0_mm", "angle0_deg")
BENCH = "script/bench: "
_FIGURE = re.compile(r"\{([\w.]+):([^}]*)\}")


def load(path=LIST):
    """{figures: {name: {value, made_by, tolerance}}, texts: [{file, text}]}"""
    return yaml.safe_load(path.read_text())


def shown(value, form):
    """A figure as the text has it."""
    return f"{float(f'{value:.3g}'):,.0f}".replace(",", " ") if form == "t" else format(value, form)


def say(text, figures):
    """The words of a text with the values in the places of their names. KeyError: a figure that is not listed."""
    return _FIGURE.sub(lambda match: shown(figures[match[1]]["value"], match[2]), text)


def names_in(text):
    """Names of the figures of a text."""
    return [match[1] for match in _FIGURE.finditer(text)]


def pattern(words):
    """What finds these words, wherever lines break."""
    return re.compile(r"\s+".join(map(re.escape, words.split())))


def run_figures(scenario):
    """{KEY: value} of RUN_KEYS of a run in this process; lengths without sign."""
    from aras_visual_servo_controller.run.judge import judge, run_in_process
    from aras_visual_servo_controller.scenario.scenario import load_scenario

    result = judge(run_in_process(load_scenario(scenario)))
    values = {"duration_s": result.duration_s}
    for key in ("x_mm", "y_mm", "z_mm", "angle_deg"):
        name, _, unit = key.partition("_")
        values[key], values[f"{name}0_{unit}"] = abs(result.final_error[key]), abs(result.initial_error[key])
    return values


def made_by_runs(figures):
    """{name: value} of all figures that runs in this process make."""
    wanted = [name.rsplit(".", 1) for name, figure in figures.items() if figure["made_by"] == "run"]
    runs = {scenario: run_figures(scenario) for scenario in sorted({scenario for scenario, _ in wanted})}
    return {f"{scenario}.{key}": runs[scenario][key] for scenario, key in wanted}


def made_by_bench(figures, measured):
    """{name: value} of all figures that script/bench measured. KeyError: a row that it does not have."""
    return {name: measured[figure["made_by"][len(BENCH):]] for name, figure in figures.items()
            if figure["made_by"].startswith(BENCH)}


def sweep_figures(folder):
    """(scenario, {KEY: value}) of a sweep: counts, of runs that every metric speaks of too, and medians."""
    from aras_visual_servo_controller.sweep.metrics import known_metrics
    from aras_visual_servo_controller.sweep.statistics import aggregate
    from aras_visual_servo_controller.sweep.store import SweepStore

    with SweepStore.open(folder) as store:
        rows, scenario = store.rows(), store.meta["setup"]["scenario"]["name"]
    numbers = aggregate(rows)
    values = {"drawn": numbers["runs"], "refused": numbers["infeasible"], "feasible": numbers["feasible"],
              "rate": 100.0 * numbers["success"], "error_mm": numbers["error_median_mm"],
              "angle_deg": numbers["angle_median_deg"]}
    for metric in known_metrics():
        said = [row[metric.name] for row in rows if row["outcome"] != "infeasible" and row[metric.name] is not None]
        values[metric.name], values[f"{metric.name}_of"] = sum(said), len(said)
    return scenario, values


def made_by_sweep(figures, folder):
    """{name: value} of all figures `sweep.SCENARIO.KEY` of that sweep."""
    scenario, values = sweep_figures(folder)
    prefix = f"sweep.{scenario}."
    return {name: values[name[len(prefix):]] for name in figures if name.startswith(prefix)}


def renew(listed, made, root=ROOT):
    """Put what was made into the list and into the texts. Returns [(name, before, now)] of what changed."""
    before = {text["text"]: say(text["text"], listed["figures"]) for text in listed["texts"]}
    changes = []
    for name, value in made.items():
        value = float(f"{value:.4g}")
        if value != listed["figures"][name]["value"]:
            changes.append((name, listed["figures"][name]["value"], value))
            listed["figures"][name]["value"] = value
    for text in listed["texts"]:
        words = say(text["text"], listed["figures"])
        if words != before[text["text"]]:
            page = root / text["file"]
            new, count = pattern(before[text["text"]]).subn(lambda _, words=words: words, page.read_text())
            if count != 1:
                raise SystemExit(f"figures: {text['file']}: found {count} times '{before[text['text']]}', allowed once")
            page.write_text(new)
    return changes


def save(listed, path=LIST):
    lines = [HEADER, "figures:\n"]
    lines += [f"  {name}: {json.dumps(figure)}\n" for name, figure in listed["figures"].items()]
    lines += ["texts:\n", *(f"- {json.dumps(text)}\n" for text in listed["texts"])]
    path.write_text("".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", metavar="FILE", type=pathlib.Path, help="what script/bench --figures FILE wrote")
    parser.add_argument("--sweep", metavar="FOLDER", action="append", default=[],
                        help="folder of a sweep whose figures docs/sweeps.md states; may be given several times")
    listed = load()
    arguments = parser.parse_args()
    made = made_by_runs(listed["figures"])
    for folder in arguments.sweep:
        made.update(made_by_sweep(listed["figures"], folder))
    if arguments.bench:
        made.update(made_by_bench(listed["figures"], json.loads(arguments.bench.read_text())))
    for name, before, now in renew(listed, made):
        print(f"{name}: {before:g} -> {now:g}")
    save(listed)


if __name__ == "__main__":
    main()
