"""The verb `compare sweeps | laws | runs`."""

import os
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from aras_visual_servo import ParameterError, cli

FOLDER = "comparisons"


def _folder(arguments: Namespace, kind: str) -> Path:
    from ..report.report import create_result_folder
    return create_result_folder(Path(arguments.output) / FOLDER, kind, arguments.name)


def _sweeps_options(parser: ArgumentParser) -> None:
    parser.add_argument("sweeps", nargs="+", type=cli.file, metavar="FOLDER",
                        help="folders of sweeps, which are called A, B, C, ... in this order; each is compared with A")
    parser.add_argument("--fail-if", action="append", default=[], metavar="EXPRESSION",
                        help="exit with code 1 if this holds, or if runs of a sweep are missing, e.g. "
                             "\"success<0.98\" or \"B.time_median_s>1.1*A.time_median_s\"; a name without a letter "
                             "means the last sweep")
    cli.add_output(parser, "comparisons/sweeps")


def _sweeps(arguments: Namespace) -> int:
    from ..compare.sweeps import LETTERS, format_comparison, gate_fires, numbers_of, save_sweeps_page
    from ..sweep.map import joint_units
    from ..sweep.store import SweepStore
    if len(arguments.sweeps) > len(LETTERS):
        raise ParameterError(f"found {len(arguments.sweeps)} sweeps, allowed {len(LETTERS)}")
    sweeps, homes, joints, missing = [], [], {}, []
    for folder in arguments.sweeps:
        with SweepStore.open(folder) as store:
            sweeps.append(store.rows())
            homes.append(store.folder.resolve())
            joints = joints or joint_units(store.meta["setup"])
            planned = len(store.starts())
        if planned > len(sweeps[-1]):
            again = cli.command_line("sweep", "--resume", homes[-1])
            missing.append(f"{folder}: {planned - len(sweeps[-1])} of {planned} runs are missing; {again} completes "
                           "them")
    names, numbers = [home.name for home in homes], numbers_of(sweeps)
    gates = [(text, *gate_fires(text, numbers)) for text in arguments.fail_if]
    print(format_comparison(names, sweeps))
    for text, fires, predicate in gates:
        print(f"gate {'FAILED' if fires else 'ok'}: {text} {predicate}")
    for sentence in missing:
        print(f"gate FAILED: {sentence}" if gates else f"note: {sentence}", file=sys.stdout if gates else sys.stderr)
    path = save_sweeps_page(names, homes, sweeps, gates, _folder(arguments, "sweeps"), arguments.repeat, joints,
                            missing)
    print(f"{'report':<20}{path}")
    failed = any(fires for _, fires, _ in gates) or (gates and missing)  # what is missing could make a gate fire
    return cli.EXIT_FAILED if failed else cli.EXIT_PASSED


def _laws_options(parser: ArgumentParser) -> None:
    parser.add_argument("comparison", nargs="?", default="canonical", type=cli.scenario_name,
                        help="name of a comparison of this package, or path of a YAML file (default: canonical)")
    parser.add_argument("--laws", type=cli.names, default=(), metavar="A,B,...",
                        help="laws to run, in this order (default: all of the comparison); a law that the comparison "
                             "does not name runs with the values of its scenario; NAME:INTERACTION runs a law with "
                             "another value of servo.interaction, e.g. points:mean")
    parser.add_argument("--tasks", type=cli.names, default=(), metavar="A,B,...",
                        help="tasks of the comparison to run (default: all)")
    parser.add_argument("--scenario", type=cli.scenario_name, metavar="SCENARIO",
                        help="name or path of a scenario to take in place of the comparison's, e.g. free_camera: the "
                             "same tasks on another robot")
    cli.add_changes(parser, law=False)
    cli.add_workers(parser, scheduler=False)
    cli.add_output(parser, "comparisons/COMPARISON")
    parser.add_argument("--list", action="store_true", help="only list the laws and tasks of the comparison")


def _laws(arguments: Namespace) -> int:
    from ..compare.laws import load_comparison, run_comparison
    comparison = load_comparison(arguments.comparison, arguments.laws, arguments.tasks, cli.changes_of(arguments),
                                 arguments.scenario)
    if arguments.list:
        for law, scenario in comparison.scenarios.items():
            print(f"law   {law:<20} {scenario.servo['law']} on {', '.join(scenario.servo.get('features', []))}")
        for task in comparison.tasks:
            print(f"task  {task.name:<20} {task.title}")
        return cli.EXIT_PASSED
    from ..compare.laws_report import format_table, save_comparison
    folder = _folder(arguments, comparison.name)
    workers = (os.cpu_count() or 1) if arguments.workers is None else arguments.workers
    results = run_comparison(comparison, workers,
                             lambda done, total: print(f"{done}/{total} laws", file=sys.stderr))
    path = save_comparison(comparison, results, folder, arguments.repeat)
    print(format_table(comparison, results))
    print(f"\n{'report':<20}{path}")
    return cli.EXIT_PASSED


def _runs_options(parser: ArgumentParser) -> None:
    parser.add_argument("runs", nargs="+", type=_run_name, metavar="RUN", help="a scenario, by name or path of its "
                        "YAML file, which is then run in this process; or a result folder, a bag, or a folder of bags")
    cli.add_changes(parser)
    cli.add_output(parser, "comparisons/runs")


def _runs(arguments: Namespace) -> int:
    from ..compare.side_by_side import format_runs, read_run, save_side_by_side
    if len(arguments.runs) < 2:
        raise ParameterError(f"found {len(arguments.runs)} run, allowed two or more")
    changes = cli.changes_of(arguments)
    runs = [read_run(source, changes) for source in arguments.runs]
    path = save_side_by_side(runs, _folder(arguments, "runs"), arguments.repeat)
    print(format_runs(runs))
    print(f"{'report':<20}{path}")
    return cli.EXIT_PASSED


def _run_name(text: str) -> str:
    return cli.file(text) if text.endswith(".bag") or os.path.isdir(text) else cli.scenario_name(text)


VERBS = {"compare": {
    "sweeps": cli.Command(
        "Compare sweeps of the same starts. Statistics are paired: McNemar's test for success, Wilcoxon's for time and "
        "error. The page compare.html shows them with maps.",
        [("FOLDER_A FOLDER_B", "two sweeps of the same starts, paired"),
         ('FOLDER_A FOLDER_B --fail-if "B.success<0.98"', "as a gate: exit code 1 if it holds")],
        _sweeps_options, _sweeps),
    "laws": cli.Command(
        "Run several laws on the same tasks. One table (comparison.csv, comparison.html) and one figure show the "
        "results.",
        [("canonical", "every law on every canonical task"),
         ("canonical --laws pbvs,points:mean --tasks turn_90", "two laws on one task"),
         ("canonical --laws pbvs,bounded --plugins my_servo", "beside a law of your own"),
         ("canonical --scenario free_camera", "the same tasks with a free-flying camera")],
        _laws_options, _laws),
    "runs": cli.Command(
        "Show two or more runs side by side. The page runs.html has camera path, errors, joints against their limits, "
        "and the differences.",
        [("naive_inverse redundant", "two scenarios, run here"),
         ("results/experiment_1/STAMP mine.yaml", "the run of a result folder beside a scenario")],
        _runs_options, _runs)}}
