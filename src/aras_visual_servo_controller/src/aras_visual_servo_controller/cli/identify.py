"""The verb `identify`: the arm that a bag shows, as a robot that scenarios extend; and a motion that tells more."""

import json
import math
import os
import sys
import time
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Tuple

import numpy as np
import yaml

from aras_visual_servo import ParameterError, Scenario, cli, load_scenario, robot_kinematics, study
from aras_visual_servo.spatial import inverse
from ..bags.any_bag import AnyBag
from ..bags.joint_log import JointLog, read_joint_log
from ..calibration.boards import KINDS, Board
from ..identification.estimates import Estimate, Identified

#: Positions may be beyond the limits of the URDF by this. [m or rad]
BEYOND = 0.1
OVERLAY, PAGE, NUMBERS, MOTION = "robot.identified.yaml", "identified.html", "identified.json", "excite.yaml"
CAMERA = "camera.yaml"
#: Without a terminal, progress is shown at this distance. [s]
SHOWN_S = 30.0
#: End of the names of the loops' bandwidths (-3 dB).
BANDWIDTH = ".bandwidth"

NOT_CONVERGED = (f"the fit of the joints did not converge: its values have no intervals, and {OVERLAY} is not written. "
                 "Record a longer motion, or start from a model that is nearer to the arm.")
MODEL_ERROR = ("the model leaves {:.1f} times the noise of the joint states: the arm has something that the model "
               "lacks, such as jitter of commands, elastic joints or other inertias than those of the URDF. The "
               "intervals count it as noise that is correlated over 0.5 s; it may shift values by more.")


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("bag", nargs="?", type=cli.file, metavar="BAG",
                        help="a ROS 1 bag or a folder of its parts; a rosbag2 or an MCAP file needs "
                             "`script/bootstrap --extras`")
    parser.add_argument("--robot", required=True, type=cli.scenario_name, metavar="NAME",
                        help="the arm's model: a named arm, or the scenario file that `robot add` made of a URDF")
    parser.add_argument("--payload", metavar="LINK", help="fit a payload on this link")
    parser.add_argument("--joint-states", metavar="TOPIC", help="topic of the joint states, where the bag has two arms")
    parser.add_argument("--board", choices=KINDS,
                        help="also fit camera and image delay from images of a resting board of this kind")
    parser.add_argument("--columns", type=int, help="of the board: inner corners, or circles, in a row")
    parser.add_argument("--rows", type=int, help="of the board: rows of them")
    parser.add_argument("--size-m", type=float,
                        help="of the board: side of a square, or distance of rows of circles [m]")
    parser.add_argument("--link", help="link that carries the camera, for robot.hand_eye")
    parser.add_argument("--images", metavar="TOPIC", help="topic of the images, where the bag has several")
    parser.add_argument("--excite", action="store_true",
                        help=f"design a motion within the limits that tells the parameters, and write it to {MOTION}; "
                             "without BAG nothing else is done")
    parser.add_argument("--seconds", type=float, default=20.0, help="length of that motion (default: 20)")
    parser.add_argument("--out", default="identified", type=cli.file, metavar="DIR",
                        help="folder for the results (default: identified)")


def _identify(arguments: Namespace) -> int:
    if arguments.bag is None and not arguments.excite:
        raise ParameterError("BAG: found nothing, allowed a bag, or --excite")
    scenario = load_scenario(arguments.robot)
    made: Dict[str, str] = {}
    if arguments.bag is not None:
        made = _identified(arguments, scenario)
    if arguments.excite:
        from ..identification.excite import design, trajectory_yaml
        motion = design(scenario, arguments.seconds)
        made[MOTION] = trajectory_yaml(motion)
        print(f"motion of {arguments.seconds:g} s, condition number {motion.condition:.3g}")
    folder = Path(arguments.out)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in made.items():
        (folder / name).write_text(text, encoding="utf-8")
    print(f"{folder}: {', '.join(made)} written")
    if OVERLAY in made:
        print(f"run the twin:  {cli.command_line('run', folder / OVERLAY)}")
    return cli.EXIT_PASSED if OVERLAY in made or arguments.bag is None else cli.EXIT_FAILED


def _identified(arguments: Namespace, scenario: Scenario) -> Dict[str, str]:
    """The files of the result, name -> text."""
    from ..identification.fit import EXPLAINED
    from ..identification.twin import identify_twin
    recording, notes = _recording(arguments, scenario)
    seen = _seen(arguments, scenario, recording)
    twin = identify_twin(recording, scenario, arguments.payload, progress=_progress())
    found = twin.identified
    if seen is not None:
        found = Identified({**found.estimates, **seen.identified.estimates}, found.unknown + seen.identified.unknown,
                           found.residual)
        print(f"corners, root mean square error: {seen.residual_px:.2g} px, held-out part {seen.held_out_px:.2g} px")
    rows = _rows({**found.estimates, **{name + BANDWIDTH: each for name, each in twin.bandwidth.items()}})
    unknown = [{"name": each.name, "others": ", ".join(each.not_apart_from), "motion": each.motion}
               for each in found.unknown]
    for row in rows:
        print("{name:<36}{value:>12}   {interval:<28}{unit}".format(**row))
    for row in unknown:
        apart = f"cannot be told apart from {row['others']}" if row["others"] else "this bag does not tell it"
        print(f"{row['name']}: {apart}; {row['motion']}")
    remark = NOT_CONVERGED if not twin.converged else MODEL_ERROR.format(twin.by_noise) if twin.by_noise > EXPLAINED \
        else None
    if remark is not None:
        notes += (remark,)
        print(remark)
    held, units = twin.held_out, study("report.joint_units").shown_units(scenario.urdf_xml())
    print("held-out part, root mean square error: " + ", ".join(
        f"{name} {units[name][0] * value:.2g} {units[name][1]}" for name, value in held.items()))
    numbers = {"robot": arguments.robot, "bag": arguments.bag, "held_out": held, "residual": found.residual,
               "converged": twin.converged, "residual_by_noise": twin.by_noise,
               "estimates": {name: {"value": each.value, "unit": each.unit, **(
                   {"stddev": each.stddev, "interval": each.interval} if math.isfinite(each.stddev) else {})}
                   for name, each in found.estimates.items()},
               "bandwidth_hz": {name: each.value for name, each in twin.bandwidth.items()},
               "unknown": [{"name": each.name, "not_apart_from": each.not_apart_from, "motion": each.motion}
                           for each in found.unknown],
               "covariance": {"names": twin.names, "matrix": twin.covariance.tolist()} if twin.converged else None}
    page = study("report.identified").identified_html(
        f"{scenario.name} as {Path(arguments.bag).name} shows it", arguments.repeat, twin.joint_names, twin.times_s,
        twin.measured, twin.simulated, twin.fitted, rows, unknown, notes, units)
    section = twin.overlay
    made = {}
    if seen is not None:
        numbers["corners_px"] = {"residual": seen.residual_px, "held_out": seen.held_out_px}
        section = _with_images(arguments, scenario, section, seen)
        made[CAMERA] = seen.camera.as_yaml()
    remarks = [f"The bag does not tell {', '.join(row['name'] for row in unknown)}."] if unknown else []
    if twin.bandwidth:
        remarks.append("Bandwidth of the loops (-3 dB): "
                       + ", ".join(f"{name} {each.value:.3g} Hz" for name, each in twin.bandwidth.items()) + ".")
    if twin.converged:
        made[OVERLAY] = _overlay(arguments, scenario, section, remarks)
    return {**made, PAGE: page, NUMBERS: json.dumps(numbers, indent=1) + "\n"}


def _progress() -> Callable[[float, float], None]:
    """Shows the iterations: in a terminal on one line, elsewhere every SHOWN_S."""
    begun = shown = time.monotonic()
    terminal = sys.stderr.isatty()

    def told(seconds: float, error: float) -> None:
        nonlocal shown
        if not terminal and time.monotonic() - shown < SHOWN_S:
            return
        shown = time.monotonic()
        print(f"{time.monotonic() - begun:5.0f} s: fitting {seconds:3.0f} s of the recording, error "
              f"{error:.3g} times the noise   ", end="\r" if terminal else "\n", file=sys.stderr, flush=True)
    return told


def _rows(estimates: Dict[str, Estimate]) -> List[Dict[str, str]]:
    """Rows of the table. Estimates of a fit that did not converge have no interval; those of other fits have theirs."""
    return [{"name": name, "value": f"{each.value:.5g}", "unit": each.unit,
             "interval": "{:.5g} to {:.5g}".format(*each.interval) if math.isfinite(each.stddev) else "unknown"}
            for name, each in estimates.items()]


def _seen(arguments: Namespace, scenario: Scenario, recording: Any) -> Any:
    """`SeenArm` of the images, or None without --board."""
    if arguments.board is None:
        return None
    from ..identification.board_views import read_board_views
    from ..identification.images import Sightings, identify_images
    lacking = [f"--{key.replace('_', '-')}: found none, allowed with --board that of the board"
               for key in ("columns", "rows", "size_m") if getattr(arguments, key) is None]
    if lacking:
        raise ParameterError(lacking)
    board = Board(arguments.board, arguments.columns, arguments.rows, arguments.size_m)
    with AnyBag(arguments.bag) as bag:
        camera, times_s, pixels = read_board_views(bag, board, arguments.images)
    return identify_images(recording, Sightings(times_s, pixels), board, camera, scenario.kinematics())


def _with_images(arguments: Namespace, scenario: Scenario, section: Dict[str, Any], seen: Any) -> Dict[str, Any]:
    """The overlay with the delay of the images, and with the camera on --link where the images tell its place."""
    from ..identification.images import HAND_EYE, OFFSET
    told = seen.identified.estimates
    section = dict(section)
    if "image_delay_s" in told:
        section["real"] = {"image_delay_s": round(max(told["image_delay_s"].value, 0.0), 6)}
    offsets = {name[:-len(OFFSET)]: round(told[name].value, 6) for name in told if name.endswith(OFFSET)}
    if offsets:
        section["robot"] = {**section["robot"], "joint_offsets": offsets}
    if arguments.link is not None and all(name in told for name in HAND_EYE):
        camera = scenario.kinematics()
        q = scenario.goal_posture(camera)
        link = robot_kinematics(scenario.urdf_xml(), scenario.robot["base_link"], arguments.link)
        X_FC = inverse(link.pose(link.vector(camera.by_name(q)))) @ camera.camera(q)
        section["robot"] = {**section["robot"], "hand_eye": {"link": arguments.link, **seen.hand_eye(X_FC)}}
    return section


def _overlay(arguments: Namespace, scenario: Scenario, section: Dict[str, Any], remarks: List[str]) -> str:
    base = arguments.robot
    if os.sep in base:
        base = os.path.relpath(base, arguments.out)
        base = base if os.sep in base else os.path.join(os.curdir, base)
    lines = [f"# {scenario.name} as {Path(arguments.bag).name} shows it. Put it under any scenario:",
             f"#   extends: [{OVERLAY}, SCENARIO]", *(f"# {remark}" for remark in remarks)]
    document = {"name": f"{scenario.name}_identified", "description": f"{scenario.name}, identified from a bag.",
                "extends": base, **{key: value for key, value in section.items() if value}}
    return "\n".join(lines) + "\n" + yaml.safe_dump(document, sort_keys=False)


def _recording(arguments: Namespace, scenario: Scenario) -> Tuple[Any, Tuple[str, ...]]:
    """(`Recording`, notes) of the bag."""
    from ..identification.recording import Commands, Recording
    from ..identification.replayed import period_of
    kinematics = scenario.kinematics(calibrated=False)
    with AnyBag(arguments.bag) as bag:
        log = read_joint_log(bag, kinematics.joint_names, scenario.controllers(), arguments.joint_states,
                             "velocity" if scenario.real.get("command") == "velocity" else "position",
                             step_s=period_of(scenario))
        notes = bag.notes
    faults = [] if log.kind is not None else [
        f"bag '{arguments.bag}': commands: found none, allowed JointState on joint_command, or Float64, "
        "Float64MultiArray or JointTrajectory on CONTROLLER/command"]
    faults += _limit_faults(log, kinematics)
    try:
        commands = None if log.kind is None else Commands(log.kind, log.told_s, log.told)
        recording = Recording(log.names, log.times_s, log.position, log.velocity, log.effort, commands, log.received_s)
    except ParameterError as error:
        raise ParameterError([*faults, *error.faults]) from None
    if faults:
        raise ParameterError(faults)
    return recording, notes


def _limit_faults(log: JointLog, kinematics: Any) -> Iterator[str]:
    sides = [("position", log.position)] + ([("commands", log.told)] if log.kind == "position" else [])
    for what, values in sides:
        for name, low, high, column in zip(log.names, kinematics.lower, kinematics.upper, np.transpose(values)):
            least, most = float(np.nanmin(column)), float(np.nanmax(column))
            if least < low - BEYOND or most > high + BEYOND:
                yield (f"{what} of {name}: found {least:.4g} to {most:.4g}, allowed {low:.4g} to {high:.4g}, the "
                       "limits of the URDF (rad, not degrees)")


VERBS = {"identify": cli.Command(
    "Identify an arm from a bag of its joint states and commands. Friction, loops, payload, gravity and delay are "
    "fitted, each with a 95 % interval, and the robot is written as a file that scenarios extend.",
    [("run.bag --robot iiwa7 --payload tool0", "a named arm with a payload"),
     ("--excite --robot ur5e", "a motion that tells the parameters, to play on the arm and record")],
    _options, _identify)}
