"""What makes the figures of docs/figures.yaml: a function for each kind of `made_by`."""
import ast
import json
import math
import pathlib
import re

import comparison

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Keys of a run; `tracking_mm`, `tracking_deg` are rms values against a goal that moves.
RUN_KEYS = ("x_mm", "y_mm", "z_mm", "angle_deg", "duration_s", "x0_mm", "y0_mm", "z0_mm", "angle0_deg",
            "error_mm", "error0_mm", "tracking_mm", "tracking_deg")
#: Keys of a cell of docs/comparison.md.
CELL_KEYS = ("error", "detour")
BENCH, TEST = "script/bench: ", "test "


def run_figures(scenario, settings=None, motion=None):
    """{KEY: value} of RUN_KEYS of a run in this process; lengths without sign.

    Args:
        scenario: its name.  settings: {dotted path: value}.  motion: what the first model of the scene does.
    """
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import judge, tracking
    from aras_visual_servo.scenario.scenario import load_scenario

    settings = dict(settings or {})
    if motion:
        first, *others = load_scenario(scenario).sim["scene"]["models"]
        settings["sim.scene.models"] = [{**first, "motion": motion}, *others]
    record = avs.run(load_scenario(scenario, settings))
    result, followed = judge(record), tracking(record)
    values = {"duration_s": result.duration_s, "tracking_mm": followed["position_mm"],
              "tracking_deg": followed["angle_deg"]}
    for zero, errors in (("", result.final_error), ("0", result.initial_error)):
        values[f"error{zero}_mm"] = math.hypot(*(errors[key] for key in ("x_mm", "y_mm", "z_mm")))
        for key in ("x_mm", "y_mm", "z_mm", "angle_deg"):
            name, _, unit = key.partition("_")
            values[f"{name}{zero}_{unit}"] = abs(errors[key])
    return values


def made_by_runs(listed):
    """{name: value} of all figures that runs in this process make."""
    wanted = [name.rsplit(".", 1) for name, figure in listed["figures"].items() if figure["made_by"] == "run"]
    runs = {}
    for name in sorted({name for name, _ in wanted}):
        run = (listed.get("runs") or {}).get(name, {"scenario": name})
        runs[name] = run_figures(run["scenario"], run.get("set"), run.get("motion"))
    return {f"{name}.{key}": runs[name][key] for name, key in wanted}


def made_by_tables(figures, page=None):
    """{name: value} of all figures TABLE.LAW.TASK.KEY that cells of docs/comparison.md make."""
    page, made = page or (ROOT / "docs" / "comparison.md").read_text(), {}
    for name, figure in figures.items():
        if figure["made_by"] == "table":
            table, law, task, key = name.split(".")
            error, ended, detour = comparison.numbers(comparison.read(page, table)[law, task])
            if key == "error" and error is None:
                raise SystemExit(f"figures: {name}: that run ended with '{ended}', it has no final error")
            made[name] = {"error": error, "detour": detour}[key]
    return made


def made_by_bench(figures, measured):
    """{name: value} of all figures that script/bench measured. KeyError: a row that it does not have."""
    return {name: measured[figure["made_by"][len(BENCH):]] for name, figure in figures.items()
            if figure["made_by"].startswith(BENCH)}


def sweep_figures(folder):
    """(scenario, {KEY: value}) of a sweep: counts, of runs that every metric speaks of too, and medians."""
    from aras_visual_servo_study.sweep.metrics import known_metrics
    from aras_visual_servo_study.sweep.statistics import aggregate
    from aras_visual_servo_study.sweep.store import SweepStore

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


def made_by_stop_rule(figures, path):
    """{name: value} of all figures `stop_rule.KEY`, of the lines of JSON that `script/bench --stop-rule` wrote."""
    from aras_visual_servo_study.sweep.statistics import wilson
    from aras_visual_servo_study.sweep.stop_rule import tally

    counts = dict(tally([json.loads(line) for line in path.read_text().splitlines()])["all"])
    counts["missed_percent"] = 100.0 * counts["missed"] / counts["inside"]
    counts["wrong_percent"] = 100.0 * wilson(counts["false_converged"], counts["converged"])[1]
    return {name: counts[name.partition(".")[2]] for name in figures if name.startswith("stop_rule.")}


def fault_of_test(made_by, value, root=ROOT):
    """What is wrong with `test PATH::NAME` as the source of a value, or None: that test is there and has the number.

    The number stands in the test itself or in a constant of its file, in C++ also of a file of test/support that it
    includes. Tests state shares as numbers up to 1: a figure whose name ends with `percent` is given so.
    """
    path, _, name = made_by[len(TEST):].partition("::")
    if not (root / path).is_file():
        return f"no file '{path}'"
    text = (root / path).read_text()
    if path.endswith(".py"):
        body = _python_test(text, name)
    else:
        support = root / path.partition("/test/")[0] / "test" / "support"
        headers = [support / header for header in re.findall(r'#include "(\w+\.hpp)"', text)]
        body = _cpp_test(text, name, "\n".join(header.read_text() for header in headers if header.is_file()))
    if body is None:
        return f"no test '{name}' in {path}"
    numbers = re.findall(r"(?<![\w.])\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?!\w)", body)
    if not any(math.isclose(float(number), value) for number in numbers):
        return f"{value:g} is not in the test '{name}' of {path}, nor in a constant there"
    return None


def _python_test(text, name):
    nodes = ast.parse(text).body
    test = [node for node in nodes if isinstance(node, ast.FunctionDef) and node.name == name]
    if not test:
        return None
    constants = [node for node in nodes if isinstance(node, ast.Assign)]
    return "\n".join(ast.unparse(node) for node in test + constants)


def _cpp_test(text, name, support):
    found = re.search(rf"^TEST(?:_[FP])?\(\w+, {name}\).*?^}}", text, re.MULTILINE | re.DOTALL)
    return found and "\n".join([found[0], *re.findall(r"^const(?:expr)? .*?;", text + support, re.MULTILINE)])
