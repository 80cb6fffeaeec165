"""The verb `robot show | check | add | meshes`; `show`, which may be left out: an arm as the controller sees it."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np

from . import EXIT_PASSED, Command, file, robot_add, robot_check, robot_meshes


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("robot", help="name of a scenario, path of its YAML file, or path of a URDF")
    parser.add_argument("--base-link", default="world", metavar="LINK",
                        help="of a URDF: where the chain begins (default: world)")
    parser.add_argument("--tip-link", default="camera_optical_frame", metavar="LINK",
                        help="of a URDF: where it ends (default: camera_optical_frame)")


def _work(arguments: Namespace) -> int:
    from ..arm.robot import robot_kinematics
    from ..scenario.scenario import load_scenario
    if arguments.robot.endswith(".urdf"):
        base, tip, where = arguments.base_link, arguments.tip_link, "with the joints at zero, or at the nearest limit"
        arm = robot_kinematics(Path(file(arguments.robot)).read_text(encoding="utf-8"), base, tip)
        q = np.clip(np.zeros(len(arm.joint_names)), arm.lower, arm.upper)
    else:
        scenario = load_scenario(arguments.robot)
        base, tip, where = scenario.robot["base_link"], scenario.robot["tip_link"], "at the goal"
        arm = robot_kinematics(scenario.urdf_xml(), base, tip)
        q = scenario.goal_posture(arm)
    print(f"{'joint':<16}{'position':>10}{'lower':>10}{'upper':>10}{'velocity':>10}   [m, rad; m/s, rad/s]")
    for row in zip(arm.joint_names, q, arm.lower, arm.upper, arm.velocity):
        print(f"{row[0]:<16}" + "".join(f"{value:>10.4g}" for value in row[1:]))
    X = arm.pose(q)
    print(f"{tip} in {base} {where}: position {np.round(X[:3, 3], 6).tolist()} m, optical axis "
          f"{np.round(X[:3, 2], 6).tolist()}")
    return EXIT_PASSED


VERBS = {"robot": {
    "show": Command("Print the chain of joints that carries the camera, their limits, and where the camera is.",
                    [("experiment_1", "the arm of a scenario"),
                     ("arm.urdf --base-link world --tip-link camera_link", "an arm of your own")],
                    _options, _work),
    "check": robot_check.COMMAND,
    "add": robot_add.COMMAND,
    "meshes": robot_meshes.COMMAND,
}}
