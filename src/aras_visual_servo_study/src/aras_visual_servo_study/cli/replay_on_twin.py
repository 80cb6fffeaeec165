"""The verb `replay-on-twin BAG`: a recorded run again, on the twin of its arm."""

import json
from argparse import ArgumentParser, Namespace
from pathlib import Path

from aras_visual_servo import cli, load_scenario, sister, styles

PAGE, NUMBERS, SCENARIO = "on_twin.html", "on_twin.json", "twin.yaml"


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("bag", type=cli.file, help="the bag of a servo run, or a folder of its bags")
    parser.add_argument("--robot", type=cli.scenario_name, metavar="OVERLAY",
                        help="the twin, as `identify` wrote it: robot.identified.yaml (default: the robot of the bag)")
    parser.add_argument("--scenario", type=cli.scenario_name,
                        help="name or path of the scenario that ran; needed if the bag does not hold it")
    parser.add_argument("--namespace", help="namespace of the run; needed if the bag holds several runs")
    parser.add_argument("--out", default="on_twin", type=cli.file, metavar="DIR",
                        help="folder for the results (default: on_twin)")


def _work(arguments: Namespace) -> int:
    from ..compare.on_twin import differences, image_age_s, replay_on_twin
    from ..compare.on_twin_page import on_twin_html, text_of
    from ..report.joint_units import shown_units
    from ..report.report import create_result_folder
    bags = sister("aras_visual_servo_controller", "bags.bag", "`aras-servo replay-on-twin`")
    scenario = load_scenario(arguments.scenario) if arguments.scenario else None
    run = replay_on_twin(bags.read_bag(arguments.bag, arguments.namespace, scenario), arguments.robot,
                         image_age_s(arguments.bag, arguments.namespace))
    numbers, folder = differences(run), Path(arguments.out)
    title = f"{run.measured.scenario}, measured and on the twin"
    made = {PAGE: on_twin_html(run, numbers, title, arguments.repeat), NUMBERS: json.dumps(numbers, indent=1) + "\n",
            SCENARIO: run.scenario.as_yaml()}
    create_result_folder(folder.parent, "", folder.name)
    for name, text in made.items():
        (folder / name).write_text(text, encoding="utf-8")
    for key, name in (("settling_s", "settling time [s]"), ("duration_s", "duration [s]")):
        print(f"{name:<20}measured {text_of(numbers[key]['measured']):<10}twin {text_of(numbers[key]['twin'])}")
    units = {**shown_units(run.scenario.urdf_xml()),
             **{style.name: (style.factor, style.read_unit) for style in styles(run.measured.feature_names)}}
    for kind in ("features", "joints"):
        print(f"difference of {kind}, root mean square: " + ", ".join(
            f"{name} {text_of(of['rms'], 2, units[name][0])} {units[name][1]}"
            for name, of in numbers[kind].items()))
    for note in dict.fromkeys(run.notes):
        print(f"note: {note}")
    print(f"{folder}: {', '.join(made)} written")
    return cli.EXIT_PASSED


VERBS = {"replay-on-twin": cli.Command(
    "Repeat a recorded run on the twin of its arm: the recorded scenario, from the same start. One page shows both, "
    "with settling times and differences in numbers. The twin's scenario is written too, for other gains.",
    [("run.bag --robot identified/robot.identified.yaml", "on the arm that `identify` found"),
     ("results/six_dof_points/STAMP --out again", "on the robot of the scenario itself")],
    _options, _work)}
