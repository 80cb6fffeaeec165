"""The verbs `sweep` and `rerun`. A sweep that is ended by a signal keeps the runs that were done."""

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any, Dict, Tuple

from aras_visual_servo import RobotKinematics, ParameterError, Scenario, ServoLoop, cli
from aras_visual_servo.processes import Interrupted
from ..report.drawing import Drawing
from ..sweep.plan import SweepSettings
from ..sweep.store import FILE, StoreError, SweepStore, planned_rows

FOLDER = "sweeps"


def _sweep_options(parser: ArgumentParser) -> None:
    cli.add_scenario(parser, nargs="?")
    parser.add_argument("--starts", type=int, metavar="N",
                        help="number of runs (default: sweep.starts of the scenario, else 100)")
    parser.add_argument("--method", help="how starts are sampled: latin_hypercube (default), grid or random")
    parser.add_argument("--space", help="space of the samples: camera poses (camera, the default; ball; view) or joint "
                                        "positions (joint); see docs/sweeps.md")
    parser.add_argument("--seed", type=int, help="seed of the samples (default: sweep.seed of the scenario, else 0)")
    parser.add_argument("--drive", action="store_true", default=None,
                        help="let the arm drive to goal and start as `run` does, instead of placing it there")
    cli.add_workers(parser)
    cli.add_output(parser, "sweeps/SCENARIO")
    parser.add_argument("--resume", nargs="?", const="", metavar="FOLDER",
                        help="continue an interrupted sweep (default: the newest of the scenario); runs that were "
                             "saved are not repeated")
    parser.add_argument("--axes", nargs=2, metavar=("X", "Y"),
                        help="columns of runs.csv that are the axes of the maps (default: x0_mm y0_mm, or two that "
                             "vary)")


def _sweep(arguments: Namespace) -> int:
    if arguments.scenario is None and not arguments.resume:
        raise ParameterError("SCENARIO: found nothing, allowed the name or path of a scenario (or --resume FOLDER)")
    with Drawing() as drawing:  # it is ready when the runs are done
        with _new_sweep(arguments) if arguments.resume is None else _old_sweep(arguments) as store:
            return _run(store, arguments, drawing)


def _rerun_options(parser: ArgumentParser) -> None:
    parser.add_argument("id", type=int, help="id of the run: column id of runs.csv")
    parser.add_argument("--sweep", type=cli.file, metavar="FOLDER",
                        help="folder of the sweep (default: the newest one under DIR)")
    parser.add_argument("--results", default="results", type=cli.file, metavar="DIR",
                        help="folder under which the sweeps are (default: results)")
    parser.add_argument("--output", metavar="DIR", help="folder to write to (default: FOLDER/runs/ID)")


def _rerun(arguments: Namespace) -> int:
    from ..report.report import create_result_folder, format_summary, save_results
    from ..sweep.run import SweepRunner
    from ..sweep.worker import scenario_of
    arguments.sweep = arguments.sweep or str(_newest(Path(arguments.results) / FOLDER, "*/*"))
    with SweepStore.open(Path(arguments.sweep)) as store:
        start = store.start(arguments.id)
        saved = next((row for row in store.rows() if row["id"] == arguments.id), None)
        setup, home = store.meta["setup"], store.folder
    row, record = SweepRunner(scenario_of(setup), setup["drive_to_start"]).run(start)
    if record is not None:
        target = Path(cli.file(arguments.output)) if arguments.output else home / "runs" / str(arguments.id)
        folder = create_result_folder(target.parent, "", target.name)
        print(format_summary(save_results(record, folder, cli.repeat_line(arguments))))
    else:
        print(f"run {arguments.id}: {row['outcome']}: {row['detail']}")
    if saved is None:
        print(f"{'sweep':<20}the sweep has not done this run yet, so there is nothing to compare with")
        return cli.EXIT_PASSED
    different = [name for name in row if row[name] != saved[name]]
    trace = f", trace {row['trace_hash']}" if row["trace_hash"] else ""
    print(f"{'sweep':<20}" + (f"other values than in the sweep: {', '.join(different)}" if different
                              else f"same bytes as in the sweep{trace}"))
    return cli.EXIT_FAILED if different else cli.EXIT_PASSED


def _new_sweep(arguments: Namespace) -> SweepStore:
    from ..report.report import create_result_folder
    from ..report.versions import installed_versions
    from ..sweep.engine import open_sweep
    from ..sweep.figure import check_axes
    from ..sweep.plan import make_starts
    scenario = cli.scenario_of(arguments)
    settings, kinematics = _settings(scenario, _asked(arguments))
    root = Path(arguments.output) / FOLDER
    if arguments.name and (root / scenario.name / arguments.name / FILE).exists():
        raise StoreError(f"sweep '{arguments.name}': found a sweep of this name; continue it with --resume or "
                         "choose another --name")
    starts = make_starts(settings, scenario, kinematics)
    if arguments.axes:
        check_axes(arguments.axes, planned_rows(starts))
    folder = create_result_folder(root, scenario.name, arguments.name)
    return open_sweep(folder, scenario, starts, settings.as_plain(), arguments.repeat, installed_versions())


def _old_sweep(arguments: Namespace) -> SweepStore:
    """The stored sweep to go on with. Raises ParameterError: an option differs from those that it was begun with."""
    from ..sweep.figure import check_axes
    from ..sweep.worker import make_setup
    scenario = None if arguments.scenario is None else cli.scenario_of(arguments)
    root = Path(arguments.output) / FOLDER
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
            faults = [f"{key}: found {value}, the sweep was started with {begun_with[key]}"
                      for key, value in settings.as_plain().items() if value != begun_with[key]]
            if not faults and make_setup(scenario, settings.drive_to_start) != store.meta["setup"]:
                faults = [f"scenario '{scenario.name}' or its files have changed since the sweep started, or it was "
                          "started with other values of --set"]
        elif cli.changes_of(arguments) or any(value is not None for value in _asked(arguments).values()):
            faults = ["a resumed sweep keeps its options: omit --starts, --method, --space, --seed, "
                      "--law, --plugins, --set and --drive"]
        if faults:
            raise ParameterError([f"--resume {store.folder}: {fault}" for fault in faults])
        if arguments.axes:
            check_axes(arguments.axes, planned_rows(store.starts()))
    except BaseException:
        store.close()
        raise
    return store


def _run(store: SweepStore, arguments: Namespace, drawing: Drawing) -> int:
    from ..sweep.engine import run_pending
    from ..sweep.report import format_summary, save_csv, save_report
    if arguments.axes:
        store.keep("axes", arguments.axes)
    print(f"sweep: {store.folder}", file=sys.stderr)
    try:
        run_pending(store, store.meta["setup"], arguments.workers, arguments.scheduler)
    except Interrupted as interrupt:
        save_csv(store)
        again = cli.command_line("sweep", "--resume", store.folder.resolve())
        print(f"{interrupt}: {len(store.pending())} runs are left; continue with: {again}", file=sys.stderr)
        return interrupt.exit_code
    path = save_report(store, drawing)
    print(format_summary(store))
    print(f"{'report':<20}{path}")
    return cli.EXIT_PASSED


def _asked(arguments: Namespace) -> Dict[str, Any]:
    """The settings that the command line can give; None: it does not."""
    return {"starts": arguments.starts, "method": arguments.method, "space": arguments.space, "seed": arguments.seed,
            "drive_to_start": arguments.drive}


def _settings(scenario: Scenario, changes: Dict[str, Any]) -> Tuple[SweepSettings, RobotKinematics]:
    kinematics = ServoLoop(scenario).kinematics  # a fault of the scenario is raised here, instead of in every row
    return SweepSettings.from_scenario(scenario, kinematics, **changes), kinematics


def _newest(root: Path, pattern: str) -> Path:
    found = sorted(root.glob(f"{pattern}/{FILE}"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise StoreError(f"{root}: found no sweep in this folder")
    return found[-1].parent


VERBS = {
    "sweep": cli.Command(
        "Run a scenario from many starts. The result folder gets one row per run in sweep.db and runs.csv, figures, "
        "and sweep.html.",
        [("experiment_1 --starts 200", "200 starts, on every core"),
         ("experiment_1 --starts 200 --law paper --name paper", "another law, in a named folder"),
         ("mine.yaml --law bounded --plugins my_servo", "a law of your own"),
         ("experiment_1 --resume", "continue the newest one")], _sweep_options, _sweep),
    "rerun": cli.Command(
        "Repeat one run of a sweep, check that it gives the same values as before, and write its summary, trace, "
        "figure and report.",
        [("17", "run 17 of the newest sweep once more, with a report"),
         ("17 --sweep results/sweeps/experiment_1/STAMP", "of this one")], _rerun_options, _rerun)}
