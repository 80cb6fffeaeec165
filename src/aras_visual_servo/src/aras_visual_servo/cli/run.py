"""The verb `run`: a scenario in this process or, with --ros, over ROS."""

import sys
from argparse import ArgumentParser, Namespace
from typing import Any, Callable

from . import EXIT_FAILED, EXIT_PASSED, Command, add_output, add_scenario, scenario_of
from ..ground.errors import ArasError, ParameterError
from ..studies import sister, study

ROS = "aras_visual_servo_controller"


def _over_ros() -> Any:
    return sister(ROS, "cli.over_ros", "`aras-servo run --ros`")


def _options(parser: ArgumentParser) -> None:
    add_scenario(parser)
    add_output(parser)
    parser.add_argument("--video", action="store_true", help="make video.mp4 too and show it in the report (ffmpeg)")
    parser.add_argument("--ros", action="store_true", help="run over ROS, by roslaunch, and record a bag")
    try:
        _over_ros().add_options(parser.add_argument_group("with --ros"))
    except ArasError:
        pass  # it is not installed, and --ros says so


def _work(arguments: Namespace) -> int:
    from ..scenario.feasibility import check_feasible
    if arguments.ros:
        ros = _over_ros()
        ros.check(arguments)
        scenario = scenario_of(arguments)
        check_feasible(scenario)
        return ros.run(scenario, arguments)
    given = [f"--{name}" for name in ("record", "split", "compression", "namespace", "ros2", "verbose")
             if getattr(arguments, name, None)]
    if given:
        raise ParameterError(f"{', '.join(given)}: found without --ros, allowed with it: a run in this process has "
                             "neither nodes nor a bag")
    report = study("report")
    with report.Drawing() as drawing:  # it begins while the scenario runs
        from ..runs.judge import run
        scenario = scenario_of(arguments)
        check_feasible(scenario)
        folder = report.create_result_folder(arguments.output, scenario.name)
        record = run(scenario, progress=_progress() if sys.stderr.isatty() else None,
                     **({"keep_images": True} if arguments.video else {}))
        files = study("files")
        files.write_whole(folder / files.SCENARIO_FILE, scenario.as_yaml())
        summary = report.save_results(record, folder, arguments.repeat, video=arguments.video, drawing=drawing)
    print(report.format_summary(summary))
    return EXIT_PASSED if summary["passed"] else EXIT_FAILED


def _progress() -> Callable[[float, str], None]:
    def show(t_s: float, phase: str) -> None:
        print(f"\r{t_s:7.2f} s  {phase:<14}", end="" if phase != "done" else "\n", file=sys.stderr, flush=True)
    return show


VERBS = {"run": Command(
    "Run a scenario, judge it by the true camera pose, and write a result folder with summary, trace, figure and "
    "report.",
    [("experiment_1", "in this process, in a fraction of a second"),
     ("experiment_1 --set servo.gains_per_s.xn=1.0", "with another gain"),
     ("six_dof_points --law ibvs --video", "with another law, and a video"),
     ("mine.yaml --law bounded --plugins my_servo", "a law of your own, in my_servo.py"),
     ("experiment_1 --ros --set sim.seed=3", "over ROS, with a bag")],
    _options, _work)}
