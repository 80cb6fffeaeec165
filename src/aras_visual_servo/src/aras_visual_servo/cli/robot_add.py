"""The word `robot add`: the files of an arm of your own, from its URDF."""

import re
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Dict, Optional

from . import EXIT_PASSED, Command, check_name, command_line, file, write_new
from .robot_check import add_urdf, text_of
from ..ground.errors import ArasError, ParameterError

HEAD = """\
# The arm {name}. It runs alone with the task below, and under any other scenario. From the folder above:
# `aras-servo run SCENARIO --set robot={folder}/scenario.yaml`, or extends: [{folder}/scenario.yaml, SCENARIO].
"""
#: The name of a mesh file that starts at the folder of the URDF.
RELATIVE_MESH = re.compile(r"""(<mesh\b[^>]*?\bfilename=)(["'])(?!\w+:|/)(.+?)\2""")


def _options(parser: ArgumentParser) -> None:
    add_urdf(parser)
    parser.add_argument("--name", help="name of the arm (default: that of the URDF file)")
    parser.add_argument("--folder", metavar="FOLDER", help="where the files go (default: a new folder, NAME)")
    parser.add_argument("--camera-xyz", nargs=3, type=float, metavar=("X", "Y", "Z"),
                        help="adds the camera's link to the copy of the URDF, at this place of the tip [m]")
    parser.add_argument("--camera-rpy", nargs=3, type=float, default=(0.0, 0.0, 0.0), metavar=("R", "P", "Y"),
                        help="with --camera-xyz: its roll, pitch and yaw there [rad] (default: along the tip's z)")
    parser.add_argument("--home", metavar="J1=Q1,..",
                        help="posture near the home by joint, 0 where not named [m, rad] (default: one is searched)")
    parser.add_argument("--z-star-m", type=float, default=0.45, metavar="M",
                        help="distance of the target at the goal (default: 0.45)")
    parser.add_argument("--driver", default="", metavar="CONTROLLER",
                        help="trajectory controller of the real arm's driver, e.g. /pos_joint_traj_controller")


def _home(text: Optional[str]) -> Optional[Dict[str, float]]:
    try:
        return None if text is None else {name.strip(): float(q) for name, q in (part.split("=")
                                                                                 for part in text.split(","))}
    except ValueError:
        raise ParameterError(f"--home: found {text}, allowed JOINT=NUMBER,.. [m, rad]") from None


def _work(arguments: Namespace) -> int:
    from ..scenario.new_arm import NewArm, arm_files, with_camera_link
    source = Path(arguments.urdf)
    name = arguments.name or source.stem
    check_name(name, "--name")
    if not arguments.z_star_m > 0.0:
        raise ParameterError(f"--z-star-m: found {arguments.z_star_m:g}, allowed > 0 [m]")
    folder, text = Path(file(arguments.folder or name)), text_of(arguments.urdf)
    made: Dict[str, str] = {}
    if arguments.camera_xyz:
        text = with_camera_link(text, arguments.tip, arguments.camera, arguments.camera_xyz, arguments.camera_rpy)
    if arguments.camera_xyz or source != folder / "arm.urdf":
        made["arm.urdf"] = RELATIVE_MESH.sub(
            lambda found: f"{found[1]}{found[2]}{source.parent / found[3]}{found[2]}", text)
    arm = NewArm(name, "arm.urdf", "controllers.yaml", arguments.tip, arguments.camera, arguments.z_star_m,
                 arguments.driver, _home(arguments.home))
    scenario, made["controllers.yaml"] = arm_files(arm, text, source.parent)
    made["scenario.yaml"] = HEAD.format(name=name, folder=folder.name) + scenario
    write_new(folder, made)
    print(f"{folder}: {', '.join(made)} written; run it:  {command_line('run', folder / 'scenario.yaml')}")
    fault = _unseen(folder / "scenario.yaml")
    if fault:
        print(f"note: the camera cannot teach its view at the home: {fault}. If the arm is in the image, choose "
              "another --home, --camera-xyz or --camera-rpy", file=sys.stderr)
    return EXIT_PASSED


def _unseen(path: Path) -> str:
    """Why the view at the home cannot be taught, e.g. because the arm is in the image; "" if it can."""
    from ..runs.loop import ServoLoop
    from ..scenario.scenario import load_scenario
    try:
        ServoLoop(load_scenario(path)).teach_goal()
    except ArasError as error:
        return str(error)
    return ""


COMMAND = Command("Make the files of an arm from its URDF: joint controllers, and a scenario with a home, a start and "
                  "a target within reach.",
                  [("my_arm.urdf --tip flange --camera-xyz 0 0.06 0.02", "with a camera that the URDF lacks"),
                   ("my_arm.urdf --tip flange --camera-xyz 0 0 0.05 --name mine --driver /arm_controller", "and the "
                    "controller of its driver")],
                  _options, _work)
