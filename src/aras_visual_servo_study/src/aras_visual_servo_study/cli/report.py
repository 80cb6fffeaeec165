"""The verb `report BAG`: summary, trace, figure and report of a run again, from its bag."""

import os
from argparse import ArgumentParser, Namespace
from pathlib import Path

from aras_visual_servo import cli, load_scenario, sister


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("bag", nargs="+", type=cli.file, help="the rosbag of a run, under any namespace; several bags, "
                        "or a folder of bags, are read as the parts of one run")
    parser.add_argument("--output", metavar="DIR", help="folder to write to; files of an earlier report there are "
                                                        "replaced (default: the folder of the bag)")
    parser.add_argument("--scenario", type=cli.scenario_name,
                        help="name or path of the scenario that ran; needed if the bag does not hold it")
    parser.add_argument("--namespace", help="namespace of the run; needed if the bag holds several runs")
    parser.add_argument("--video", action="store_true", help="make video.mp4 too and show it in the report (ffmpeg)")
    parser.add_argument("--panels", action="store_true", help="write each panel of the figure as panel_NAME.pdf too")
    parser.add_argument("--replay", action="store_true",
                        help="process the images again and compare the features with the recorded ones, bit for bit")


def _work(arguments: Namespace) -> int:
    from ..report.report import create_result_folder, format_summary, save_results
    bags = sister("aras_visual_servo_controller", "bags.bag", "`aras-servo report`")
    first = arguments.bag[0]
    folder = Path(cli.file(arguments.output) if arguments.output else first if os.path.isdir(first) else
                  os.path.dirname(first))
    scenario = load_scenario(arguments.scenario) if arguments.scenario else None
    record = bags.read_bag(arguments.bag, arguments.namespace, scenario, keep_images=arguments.video)
    create_result_folder(folder.parent, "", folder.name)
    summary = save_results(record, folder, arguments.repeat, video=arguments.video, panels=arguments.panels)
    print(format_summary(summary))
    passed = summary["passed"]
    if arguments.replay:
        from aras_visual_servo_controller.bags.replay import replay
        result = replay(arguments.bag, arguments.namespace, scenario)
        print(result.text())
        passed = passed and result.same
    return cli.EXIT_PASSED if passed else cli.EXIT_FAILED


VERBS = {"report": cli.Command(
    "Rebuild summary.json, trace.csv, figure.{png,pdf} and report.html of a run from its bag.",
    [("results/experiment_1/STAMP/run.bag", "everything again, from the bag"),
     ("results/experiment_1/STAMP --video --replay", "and the video; the same features?")], _options, _work)}
