"""The commands `run SCENARIO` and `report BAG`.

Exit codes: 0 the run passed, 1 it did not, 2 bad input, 3 could not run, 128 + N ended by signal N.
"""

import os
import re
import sys
from pathlib import Path

import yaml

from .parser import PREFIX, command_parser, parse
from ..ground.errors import ArasError, ParameterError
from ..processes import Interrupted, signals_raise
from ..studies import study
from aras_visual_servo_controller.bags.record_groups import COMPRESSIONS, GROUPS, ON_DEMAND, parse_groups

EXIT_PASSED, EXIT_FAILED, EXIT_PARAMETERS, EXIT_BROKEN = range(4)
NAMESPACE = re.compile(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)

RUN_EXAMPLES = (("experiment_1 --in-process", "without ROS, in a fraction of a second"),
                ("experiment_1 --in-process --set servo.gains_per_s.xn=1.0", "with another gain"),
                ("experiment_1 --set sim.seed=3", "over ROS, with a bag"),
                ("--init mine", "write mine.yaml, a scenario to begin with"),
                ("mine.yaml --in-process --video", "run it, with a video"),
                ("mine.yaml --resolve", "print it with all that it extends"))
REPORT_EXAMPLES = (("results/experiment_1/STAMP/run.bag", "everything again, from the bag"),
                   ("results/experiment_1/STAMP --video --replay", "and the video; the same features?"))


def run_main(argv=None):
    """`run SCENARIO`: over ROS through roslaunch, or without ROS with --in-process. Returns the exit code."""
    parser = command_parser("run", "Run a scenario, judge it by the true camera pose, and write a result folder with "
                            "summary, trace, figure and report.", RUN_EXAMPLES)
    parser.add_argument("scenario", nargs="?", help="name of a scenario of this package, or path of a YAML file")
    parser.add_argument("--in-process", action="store_true",
                        help="run simulator, camera and controller in this process, without ROS")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="replace a value of the scenario, e.g. --set servo.gains_per_s.xn=2.0; may be given "
                             "several times")
    parser.add_argument("--video", action="store_true", help="make video.mp4 too and show it in the report (ffmpeg)")
    parser.add_argument("--record", metavar="GROUPS", help="groups of topics to record (only over ROS), e.g. "
                        "images,features,truth for these, --record=-images for all but images, or all,segmentation "
                        "for one more; the groups are " + ", ".join(GROUPS) + " (default: all), and, recorded only "
                        "when named, " + ", ".join(ON_DEMAND))
    parser.add_argument("--split", type=int, metavar="MB",
                        help="begin a new bag file when one has reached this size (only over ROS)")
    parser.add_argument("--compression", choices=COMPRESSIONS,
                        help="compression of the bag (only over ROS; default: lz4)")
    parser.add_argument("--namespace", metavar="NAME", help="namespace of the graph, with a clock and frames of its "
                        "own, so that several runs share a master (only over ROS; default: aras_visual_servo, global "
                        "clock)")
    parser.add_argument("--verbose", action="store_true", help="show the output of the nodes (only over ROS)")
    parser.add_argument("--list", action="store_true", help="only list the scenarios that come with the package")
    parser.add_argument("--init", metavar="NAME", help="only write NAME.yaml, a scenario to begin with: it extends "
                        "SCENARIO (default: experiment_1), and every key stands there with its meaning")
    parser.add_argument("--resolve", action="store_true", help="only print the scenario as it runs, as YAML: with all "
                        "that it extends, and with --set")
    arguments = parse(parser, argv)
    from ..scenario.scenario import load_scenario
    from ..scenario.files import scenario_names
    if arguments.list:
        for name in scenario_names():
            print(f"{name:<28} {load_scenario(name).description}")
        return EXIT_PASSED
    if arguments.init:
        return guarded(lambda: _write_starter(arguments.init, arguments.scenario or "experiment_1"))
    if not arguments.scenario:
        parser.error("SCENARIO is missing; --list shows the known ones")
    if arguments.in_process and (arguments.record or arguments.split or arguments.compression):
        parser.error("--record, --split and --compression say how the bag is written, but --in-process writes no bag")
    if arguments.namespace is not None and (arguments.in_process or not NAMESPACE.fullmatch(arguments.namespace)):
        parser.error(f"--namespace: found '{arguments.namespace}', allowed is a name of ROS, letters, digits and _ "
                     "with / between, without --in-process")
    if arguments.split is not None and arguments.split < 1:
        parser.error(f"--split: found {arguments.split}, allowed >= 1")

    def work(drawing=None):
        scenario = load_scenario(arguments.scenario, parse_overrides(arguments.overrides))
        if arguments.resolve:
            print(scenario.as_yaml(), end="")
            return EXIT_PASSED
        from ..scenario.feasibility import check_feasible
        check_feasible(scenario)
        return _run_in_process(scenario, arguments, drawing) if drawing else _run_over_ros(scenario, arguments)

    def work_while_drawing_begins():
        with study("report").Drawing() as drawing:
            return work(drawing)

    return guarded(work_while_drawing_begins if arguments.in_process and not arguments.resolve else work)


def report_main(argv=None):
    """`report BAG` makes summary, trace, figure and report again from a rosbag. Returns the exit code."""
    parser = command_parser("report", "Rebuild summary.json, trace.csv, figure.{png,pdf} and report.html of a run "
                            "from its bag.", REPORT_EXAMPLES)
    parser.add_argument("bag", nargs="+", help="the rosbag of a run, under any namespace; several bags, or a folder of "
                                               "bags, are read as the parts of one run")
    parser.add_argument("--output", metavar="DIR", help="folder to write to; files of an earlier report there are "
                                                        "replaced (default: the folder of the bag)")
    parser.add_argument("--scenario", help="name or path of the scenario that ran; needed if the bag does not hold it")
    parser.add_argument("--namespace", help="namespace of the run; needed if the bag holds several runs")
    parser.add_argument("--video", action="store_true", help="make video.mp4 too and show it in the report (ffmpeg)")
    parser.add_argument("--panels", action="store_true", help="write each panel of the figure as panel_NAME.pdf too")
    parser.add_argument("--replay", action="store_true",
                        help="process the images again and compare the features with the recorded ones, bit for bit")
    arguments = parse(parser, argv)

    def work():
        from aras_visual_servo_controller.bags.bag import read_bag
        report = study("report")
        from ..scenario.scenario import load_scenario
        first = os.path.abspath(arguments.bag[0])
        folder = Path(arguments.output or (first if os.path.isdir(first) else os.path.dirname(first)))
        scenario = load_scenario(arguments.scenario) if arguments.scenario else None
        record = read_bag(arguments.bag, arguments.namespace, scenario, keep_images=arguments.video)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise report.ResultFolderError(f"results folder '{folder}': cannot be made: {error.strerror}") from error
        summary = report.save_results(record, folder, video=arguments.video, panels=arguments.panels)
        print(report.format_summary(summary))
        passed = summary["passed"]
        if arguments.replay:
            from aras_visual_servo_controller.bags.replay import replay
            result = replay(arguments.bag, arguments.namespace, scenario)
            print(result.text())
            passed = passed and result.same
        return EXIT_PASSED if passed else EXIT_FAILED

    return guarded(work)


def parse_overrides(texts):
    """Dict of dotted path -> value, of texts KEY=VALUE with values in YAML. Raises ParameterError with all bad ones."""
    overrides, faults = {}, []
    for text in texts:
        key, equals, value = text.partition("=")
        try:
            if not equals or not key:
                raise ValueError
            overrides[key] = yaml.safe_load(value)
        except (ValueError, yaml.YAMLError):
            faults.append(f"--set {text}: allowed is KEY=VALUE, e.g. sim.seed=3")
    if faults:
        raise ParameterError(faults)
    return overrides


def _write_starter(name, base):
    from ..scenario.schema import NAME
    from ..scenario.starter import starter
    name = name[:-len(".yaml")] if name.endswith(".yaml") else name
    if not re.fullmatch(NAME, name):
        raise ParameterError(f"--init: found '{name}', allowed letters, digits, _ . -, not only dots")
    path, text = Path(f"{name}.yaml"), starter(name, base)
    try:
        with open(path, "x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise ParameterError(f"--init: {path} is there already; choose another name") from None
    print(f"{path} is written; run it:  {PREFIX} run {path} --in-process")
    return EXIT_PASSED


def _run_in_process(scenario, arguments, drawing):
    from ..runs.judge import run
    report = study("report")
    folder = report.create_result_folder(arguments.output, scenario.name)
    record = run(scenario, progress=_progress() if sys.stderr.isatty() else None,
                            **({"keep_images": True} if arguments.video else {}))
    words = [f"--set {text}" for text in arguments.overrides]
    command = " ".join(["rosrun aras_visual_servo_controller run", arguments.scenario, "--in-process"] + words)
    summary = report.save_results(record, folder, command, video=arguments.video, drawing=drawing)
    print(report.format_summary(summary))
    return EXIT_PASSED if summary["passed"] else EXIT_FAILED


def _run_over_ros(scenario, arguments):
    from aras_visual_servo_controller.nodes.launch import run_over_ros
    extra = []
    if arguments.record:
        extra.append("record_groups:=" + ",".join(parse_groups(arguments.record)))
    if arguments.split:
        extra.append(f"record_split_mb:={arguments.split}")
    if arguments.compression:
        extra.append(f"record_compression:={arguments.compression}")
    if arguments.video:
        extra.append("video:=true")
    return run_over_ros(scenario, os.path.expanduser(arguments.output), extra, verbose=arguments.verbose,
                        namespace=arguments.namespace)


def _progress():
    def show(t_s, phase):
        print(f"\r{t_s:7.2f} s  {phase:<14}", end="" if phase != "done" else "\n", file=sys.stderr, flush=True)
    return show


def guarded(work):
    """Exit code of work(). If it raises, the reason is printed and the code says what kind of failure it was."""
    try:
        with signals_raise():
            return work()
    except ParameterError as error:
        print(f"bad input:\n{error}", file=sys.stderr)
        return EXIT_PARAMETERS
    except (ArasError, ImportError, RuntimeError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BROKEN
    except Interrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return interrupt.exit_code
