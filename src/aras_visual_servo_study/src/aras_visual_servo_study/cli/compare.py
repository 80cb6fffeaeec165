"""The commands `compare_laws` and `compare_runs`. Exit codes: 0 done, 2 bad input, 3 could not run, 130 interrupted."""

import os
import shlex
import sys
from pathlib import Path

from aras_visual_servo.cli.parser import command_parser, parse
from aras_visual_servo.cli.run import EXIT_PASSED, guarded, parse_overrides
from aras_visual_servo.ground.errors import ParameterError

FOLDER = "comparisons"
LAWS_EXAMPLES = (("canonical", "every law on every canonical task"),
                 ("canonical --laws pbvs,ibvs:current --tasks A_90", "two laws on one task"),
                 ("canonical --scenario free_camera", "the same tasks with a camera that flies freely"))
RUNS_EXAMPLES = (("naive_inverse redundant", "two scenarios, run here"),
                 ("results/experiment_1/STAMP mine.yaml", "a recorded run beside a scenario"))


def compare_laws_main(argv=None):
    """`compare_laws canonical --laws A,B` runs laws on the same tasks. Returns the exit code."""
    parser = command_parser("compare_laws", "Run several laws on the same tasks, and write one table (comparison.csv, "
                            "comparison.html) and one figure of the results.", LAWS_EXAMPLES)
    parser.add_argument("comparison", nargs="?", default="canonical",
                        help="name of a comparison of this package, or path of a YAML file (default: canonical)")
    parser.add_argument("--laws", type=_names, default=(), metavar="A,B,...",
                        help="laws of the comparison to run, in this order (default: all); NAME:INTERACTION runs a law "
                             "with another value of servo.interaction, e.g. ibvs:current")
    parser.add_argument("--tasks", type=_names, default=(), metavar="A,B,...",
                        help="tasks of the comparison to run (default: all)")
    parser.add_argument("--scenario", metavar="SCENARIO",
                        help="name or path of a scenario to take in place of the comparison's, e.g. free_camera: the "
                             "same tasks on another robot")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="replace a value of the base scenario, e.g. --set sim.seed=3")
    parser.add_argument("--workers", type=int, metavar="N",
                        help="number of worker processes (default: one per core; 0: run in this process)")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--name", help="name of the folder DIR/comparisons/COMPARISON/NAME (default: the time)")
    parser.add_argument("--list", action="store_true", help="only list the laws and tasks of the comparison")
    arguments = parse(parser, argv)

    def work():
        from ..compare.laws import load_comparison, run_comparison
        if arguments.workers is not None and arguments.workers < 0:
            raise ParameterError(f"--workers: found {arguments.workers}, allowed >= 0")
        comparison = load_comparison(arguments.comparison, arguments.laws, arguments.tasks,
                                     parse_overrides(arguments.overrides), arguments.scenario)
        if arguments.list:
            for law, scenario in comparison.scenarios.items():
                print(f"law   {law:<20} {scenario.servo['law']} on {', '.join(scenario.servo.get('features', []))}")
            for task in comparison.tasks:
                print(f"task  {task.name:<20} {task.title}")
            return EXIT_PASSED
        from ..compare.laws_report import format_table, save_comparison
        from ..report.report import create_result_folder
        folder = create_result_folder(Path(os.path.expanduser(arguments.output)) / FOLDER, comparison.name,
                                      arguments.name)
        workers = (os.cpu_count() or 1) if arguments.workers is None else arguments.workers
        results = run_comparison(comparison, workers, _say)
        command = "rosrun aras_visual_servo_controller compare_laws " + _words(arguments)
        path = save_comparison(comparison, results, folder, command)
        print(format_table(comparison, results))
        print(f"\n{'report':<20}{path}")
        return EXIT_PASSED

    return guarded(work)


def compare_runs_main(argv=None):
    """`compare_runs A B` shows two or more runs on one page. Returns the exit code."""
    parser = command_parser("compare_runs", "Two or more runs side by side on one page (runs.html): camera path, "
                            "errors, joints against their limits, what differs.", RUNS_EXAMPLES)
    parser.add_argument("runs", nargs="+", metavar="RUN", help="a scenario, by name or path of its YAML file, which is "
                        "then run in this process; or a recorded run: a bag, or a folder of bags")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--name", help="name of the folder DIR/comparisons/runs/NAME (default: the time)")
    arguments = parse(parser, argv)

    def work():
        from ..report.report import create_result_folder
        from ..compare.side_by_side import format_runs, read_run, save_side_by_side
        if len(arguments.runs) < 2:
            raise ParameterError(f"found {len(arguments.runs)} run, allowed two or more")
        runs = [read_run(source) for source in arguments.runs]
        folder = create_result_folder(Path(os.path.expanduser(arguments.output)) / FOLDER, "runs", arguments.name)
        command = "rosrun aras_visual_servo_controller compare_runs " + " ".join(map(shlex.quote, arguments.runs))
        path = save_side_by_side(runs, folder, command)
        print(format_runs(runs))
        print(f"{'report':<20}{path}")
        return EXIT_PASSED

    return guarded(work)


def _words(arguments):
    words = [shlex.quote(arguments.comparison)]
    words += [f"--{key} {','.join(getattr(arguments, key))}" for key in ("laws", "tasks") if getattr(arguments, key)]
    words += [f"--scenario {shlex.quote(arguments.scenario)}"] if arguments.scenario else []
    return " ".join(words + [f"--set {shlex.quote(text)}" for text in arguments.overrides])


def _names(text):
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _say(done, total):
    print(f"{done}/{total} laws", file=sys.stderr)
