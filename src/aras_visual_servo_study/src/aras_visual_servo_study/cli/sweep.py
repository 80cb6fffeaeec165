"""The commands `sweep`, `rerun` and `compare`.

Exit codes: 0 done; 1 a `--fail-if` expression held, or a repeated run gave other values; 2 bad input; 3 could not run;
128 + N ended by signal N (a sweep keeps the runs that were done).
"""

import os
import re
import shlex
import sys
from dataclasses import asdict
from pathlib import Path

from aras_visual_servo.cli.parser import command_parser, parse
from aras_visual_servo.cli.run import EXIT_FAILED, EXIT_PASSED, guarded, parse_overrides
from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.processes import Interrupted

FOLDER, COMPARISONS = "sweeps", "comparisons"
SWEEP_EXAMPLES = (("experiment_1 --starts 200", "200 starts, on every core"),
                  ("experiment_1 --starts 200 --set servo.law=paper --name paper", "another law, in a named folder"),
                  ("experiment_1 --resume", "go on where the newest one was interrupted"))
RERUN_EXAMPLES = (("17", "run 17 of the newest sweep once more, with a report"),
                  ("17 --sweep results/sweeps/experiment_1/STAMP", "of this one"))
COMPARE_EXAMPLES = (("FOLDER_A FOLDER_B", "two sweeps of the same starts, paired"),
                    ('FOLDER_A FOLDER_B --fail-if "B.success<0.98"', "as a gate: exit code 1 if it holds"))


def sweep_main(argv=None):
    """`sweep SCENARIO --starts N` runs a scenario from many starts. Returns the exit code."""
    parser = command_parser("sweep", "Run a scenario from many starts. The result folder gets one row per run in "
                            "sweep.db and runs.csv, figures, and sweep.html.", SWEEP_EXAMPLES)
    parser.add_argument("scenario", nargs="?", help="name of a scenario of this package, or path of a YAML file")
    parser.add_argument("--starts", type=int, metavar="N",
                        help="number of runs (default: sweep.starts of the scenario, else 100)")
    parser.add_argument("--method", help="how starts are sampled: latin_hypercube (default), grid or random")
    parser.add_argument("--space", help="what is sampled: camera poses (camera, the default; ball; view) or joint "
                                        "positions (joint); see docs/sweeps.md")
    parser.add_argument("--seed", type=int, help="seed of the samples (default: sweep.seed of the scenario, else 0)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="replace a value of the scenario, e.g. --set servo.law=paper; may be given several times")
    parser.add_argument("--drive", action="store_true", default=None,
                        help="let the arm drive to goal and start as `run` does, instead of placing it there")
    parser.add_argument("--workers", type=int, metavar="N",
                        help="number of worker processes on this machine (default: one per core; 0: run in this "
                             "process)")
    parser.add_argument("--scheduler", metavar="ADDRESS",
                        help="address of a Dask scheduler whose workers do the runs, e.g. tcp://host:8786")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--name", help="name of the folder DIR/sweeps/SCENARIO/NAME (default: the time)")
    parser.add_argument("--resume", nargs="?", const="", metavar="FOLDER",
                        help="go on with an interrupted sweep (default: the newest of the scenario); runs that were "
                             "saved are not repeated")
    parser.add_argument("--axes", nargs=2, metavar=("X", "Y"),
                        help="columns of runs.csv that are the axes of the maps (default: x0_mm y0_mm)")
    arguments = parse(parser, argv)
    if arguments.scenario is None and not arguments.resume:
        parser.error("SCENARIO is missing (or --resume FOLDER)")

    def work():
        from aras_visual_servo.scenario.schema import NAME
        if arguments.workers is not None and arguments.workers < 0:
            raise ParameterError(f"--workers: found {arguments.workers}, allowed >= 0")
        if arguments.name is not None and not re.fullmatch(NAME, arguments.name):
            raise ParameterError(f"--name: found '{arguments.name}', allowed letters, digits, _ . -, not only dots")
        from ..report.drawing import Drawing
        with Drawing() as drawing:  # it is ready when the runs are done
            store = _new_sweep(arguments) if arguments.resume is None else _old_sweep(arguments)
            with store:
                return _run(store, arguments, drawing)

    return guarded(work)


def rerun_main(argv=None):
    """`rerun ID` repeats one run of a sweep and writes its result folder. Returns the exit code."""
    parser = command_parser("rerun", "Repeat one run of a sweep, check that it gives the same values as before, and "
                            "write its summary, trace, figure and report.", RERUN_EXAMPLES)
    parser.add_argument("id", type=int, help="id of the run: column id of runs.csv")
    parser.add_argument("--sweep", metavar="FOLDER", help="folder of the sweep (default: the newest one under DIR)")
    parser.add_argument("--results", default="results", metavar="DIR",
                        help="folder under which the sweeps are (default: results)")
    parser.add_argument("--output", metavar="DIR", help="folder to write to (default: FOLDER/runs/ID)")
    arguments = parse(parser, argv)

    def work():
        from ..report.report import ResultFolderError, format_summary, save_results
        from ..sweep.run import SweepRunner
        from ..sweep.worker import scenario_of
        from ..sweep.store import SweepStore
        folder = Path(arguments.sweep) if arguments.sweep else _newest(Path(arguments.results) / FOLDER, "*/*")
        with SweepStore.open(folder) as store:
            start = store.start(arguments.id)
            saved = next((row for row in store.rows() if row["id"] == arguments.id), None)
            setup, home = store.meta["setup"], store.folder
        row, record = SweepRunner(scenario_of(setup), setup["drive_to_start"]).run(start)
        if record is not None:
            target = Path(arguments.output or home / "runs" / str(arguments.id))
            try:
                target.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise ResultFolderError(f"results folder '{target}': cannot be made: {error.strerror}") from error
            command = f"rosrun aras_visual_servo_controller rerun {arguments.id} --sweep {shlex.quote(str(home))}"
            print(format_summary(save_results(record, target, command)))
        else:
            print(f"run {arguments.id}: {row['outcome']}: {row['detail']}")
        if saved is None:
            print(f"{'sweep':<20}the sweep has not done this run yet, so there is nothing to compare with")
            return EXIT_PASSED
        different = [name for name in row if row[name] != saved[name]]
        print(f"{'sweep':<20}" + (f"other values than in the sweep: {', '.join(different)}" if different
                                  else f"same bytes as in the sweep, trace {row['trace_hash']}"))
        return EXIT_FAILED if different else EXIT_PASSED

    return guarded(work)


def compare_main(argv=None):
    """`compare A B [C]` compares sweeps and checks gates on their numbers. Returns the exit code."""
    parser = command_parser("compare", "Sweeps side by side, with paired statistics on the same starts: McNemar's test "
                            "for success, Wilcoxon's for time and error. The page compare.html shows them with maps.",
                            COMPARE_EXAMPLES)
    parser.add_argument("sweeps", nargs="+", metavar="FOLDER",
                        help="folders of sweeps, which are called A, B, C, ... in this order; each is compared with A")
    parser.add_argument("--fail-if", action="append", default=[], metavar="EXPRESSION",
                        help="exit with code 1 if this holds, e.g. \"success<0.98\" or "
                             "\"B.time_median_s>1.1*A.time_median_s\"; a name without a letter means the last sweep")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--name", help="name of the folder DIR/comparisons/sweeps/NAME (default: the time)")
    arguments = parse(parser, argv)

    def work():
        from ..compare.sweeps import LETTERS, format_comparison, gate_fires, numbers_of
        from ..compare.sweeps_report import save_sweeps_page
        from ..report.report import create_result_folder
        from ..sweep.store import SweepStore
        if len(arguments.sweeps) > len(LETTERS):
            raise ParameterError(f"found {len(arguments.sweeps)} sweeps, allowed {len(LETTERS)}")
        sweeps, names, homes = [], [], []
        for folder in arguments.sweeps:
            with SweepStore.open(folder) as store:
                sweeps.append(store.rows())
                homes.append(store.folder.resolve())
                names.append(homes[-1].name)
                missing = len(store.starts()) - len(sweeps[-1])
            if missing:
                print(f"note: {folder}: {missing} runs are still missing", file=sys.stderr)
        numbers = numbers_of(sweeps)
        gates = [(text, *gate_fires(text, numbers)) for text in arguments.fail_if]
        print(format_comparison(names, sweeps))
        for text, fires, why in gates:
            print(f"{'FAILED' if fires else 'passed'}: {text}   ({why})")
        folder = create_result_folder(Path(os.path.expanduser(arguments.output)) / COMPARISONS, FOLDER, arguments.name)
        words = [*arguments.sweeps, *(word for text in arguments.fail_if for word in ("--fail-if", text))]
        command = "rosrun aras_visual_servo_controller compare " + " ".join(map(shlex.quote, words))
        print(f"{'report':<20}{save_sweeps_page(names, homes, sweeps, gates, folder, command)}")
        return EXIT_FAILED if any(fires for _, fires, _ in gates) else EXIT_PASSED

    return guarded(work)


def _new_sweep(arguments):
    from ..report.report import create_result_folder
    from aras_visual_servo.scenario.scenario import load_scenario
    from ..sweep.plan import make_starts
    from ..sweep.worker import make_setup
    from ..sweep.store import FILE, StoreError, SweepStore
    from ..report.versions import installed_versions
    scenario = load_scenario(arguments.scenario, parse_overrides(arguments.overrides))
    settings, kinematics = _settings(scenario, _asked(arguments))
    if arguments.name and (Path(arguments.output) / FOLDER / scenario.name / arguments.name / FILE).exists():
        raise StoreError(f"sweep '{arguments.name}': found a sweep of this name already; go on with it by --resume, or "
                         "choose another --name")
    starts = make_starts(settings, scenario, kinematics)
    folder = create_result_folder(Path(os.path.expanduser(arguments.output)) / FOLDER, scenario.name, arguments.name)
    words = [arguments.scenario, f"--starts {settings.starts} --method {settings.method} --space {settings.space} "
                                 f"--seed {settings.seed}"]
    words += [f"--set {shlex.quote(text)}" for text in arguments.overrides] + ["--drive"] * settings.drive_to_start
    meta = {"setup": make_setup(scenario, settings.drive_to_start), "settings": _plain(settings),
            "command": f"rosrun aras_visual_servo_controller sweep {' '.join(words)}", "versions": installed_versions()}
    return SweepStore.create(folder, meta, starts)


def _old_sweep(arguments):
    """The stored sweep to go on with. Raises ParameterError: an option differs from those that it was begun with."""
    from aras_visual_servo.scenario.scenario import load_scenario
    from ..sweep.worker import make_setup
    from ..sweep.store import SweepStore
    scenario = None
    if arguments.scenario is not None:
        scenario = load_scenario(arguments.scenario, parse_overrides(arguments.overrides))
    root = Path(os.path.expanduser(arguments.output)) / FOLDER
    if arguments.resume:
        folder = Path(arguments.resume)
    else:
        folder = root / scenario.name / arguments.name if arguments.name else _newest(root / scenario.name, "*")
    store = SweepStore.open(folder, writing=True)
    try:
        faults = []
        if scenario is not None:
            begun_with = store.meta["settings"]
            settings, _ = _settings(scenario, {key: begun_with[key] if value is None else value
                                               for key, value in _asked(arguments).items()})
            faults = [f"{key}: found {value}, the sweep was begun with {begun_with[key]}"
                      for key, value in _plain(settings).items() if value != begun_with[key]]
            if not faults and make_setup(scenario, settings.drive_to_start) != store.meta["setup"]:
                faults = [f"scenario '{scenario.name}' or its files have changed since the sweep was begun, or it was "
                          "begun with other values of --set"]
        elif arguments.overrides or any(value is not None for value in _asked(arguments).values()):
            faults = ["a sweep goes on with the options it was begun with: leave --starts, --method, --space, --seed, "
                      "--set and --drive out"]
        if faults:
            raise ParameterError([f"--resume {store.folder}: {fault}" for fault in faults])
    except BaseException:
        store.close()
        raise
    return store


def _run(store, arguments, drawing):
    from ..sweep.engine import run_pending
    from ..sweep.figure import DEFAULT_AXES, check_axes
    from ..sweep.report import format_summary, save_csv, save_report
    columns = [dict.fromkeys(store.extra)]
    axes = check_axes(arguments.axes, columns) if arguments.axes else DEFAULT_AXES
    print(f"sweep: {store.folder}", file=sys.stderr)
    try:
        run_pending(store, store.meta["setup"], arguments.workers, arguments.scheduler)
    except Interrupted as interrupt:
        save_csv(store)
        left = len(store.pending())
        print(f"{interrupt}: {left} runs are left; go on with: sweep --resume {shlex.quote(str(store.folder))}",
              file=sys.stderr)
        return interrupt.exit_code
    path = save_report(store, axes, drawing)
    print(format_summary(store))
    print(f"{'report':<20}{path}")
    return EXIT_PASSED


def _asked(arguments):
    """The settings that the command line can give; None: it does not."""
    return {"starts": arguments.starts, "method": arguments.method, "space": arguments.space, "seed": arguments.seed,
            "drive_to_start": arguments.drive}


def _settings(scenario, changes):
    from aras_visual_servo.runs.loop import ServoLoop
    from ..sweep.plan import SweepSettings
    kinematics = ServoLoop(scenario).kinematics  # a fault of the scenario is raised here, instead of in every row
    return SweepSettings.from_scenario(scenario, kinematics, **changes), kinematics


def _plain(settings):
    """The settings with the types that JSON gives back, so that they can be compared with stored ones."""
    values = asdict(settings)
    values["ranges"] = {name: list(ends) for name, ends in settings.ranges.items()}
    values["goal"] = {name: list(ends) for name, ends in settings.goal.items()}
    values["perturb"] = {p.name: ", ".join(map(str, p.values)) if p.values else f"{p.low:g} to {p.high:g}"
                         for p in settings.perturbations}
    del values["perturbations"]
    return values


def _newest(root, pattern):
    from ..sweep.store import FILE, StoreError
    found = sorted(root.glob(f"{pattern}/{FILE}"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise StoreError(f"{root}: found no sweep in this folder")
    return found[-1].parent
