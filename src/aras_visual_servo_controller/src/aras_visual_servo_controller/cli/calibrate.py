"""The verb `calibrate NAME`: calibrations of a real arm from images of a board."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np
import yaml

from aras_visual_servo import ParameterError, cli, study
from ..calibration.boards import KINDS, Board
from ..calibration.camera_model import MODELS
from ..calibration.family import CALIBRATIONS, Calibrated, Request, ResidualCheck, check_residuals

BOARD = "--columns 8 --rows 5 --size-m 0.03"


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("what", choices=tuple(CALIBRATIONS), help="calibration: " + "; ".join(
        f"{name}: {each.about}" for name, each in CALIBRATIONS.items()))
    parser.add_argument("files", nargs="+", metavar="FILE",
                        help="; ".join(f"{name}: {each.files}" for name, each in CALIBRATIONS.items()))
    parser.add_argument("--board", choices=KINDS, default=KINDS[0],
                        help="a chessboard (default), or OpenCV's asymmetric grid of circles")
    parser.add_argument("--columns", type=int, required=True, help="inner corners, or circles, in a row")
    parser.add_argument("--rows", type=int, required=True, help="rows of them; with a chessboard columns + rows is odd")
    parser.add_argument("--size-m", type=float, required=True,
                        help="side of a square, or distance of rows of circles [m]")
    parser.add_argument("--model", choices=tuple(MODELS), default="plumb_bob",
                        help="camera: model of its lens; rational_polynomial for wide lenses, equidistant for fisheye "
                             "lenses (default: plumb_bob)")
    parser.add_argument("--camera", default="", metavar="FILE",
                        help="all but camera: the file that `calibrate camera` wrote")
    parser.add_argument("--scenario", default="", help="of samples with joints: the scenario with the arm: robot.urdf "
                                                       "and robot.base_link")
    parser.add_argument("--link", default="", help="the link that carries the camera; eye_to_hand: the board")
    parser.add_argument("--z-star-m", type=float, default=0.5, metavar="M",
                        help="depth of the target at the goal, at which the error is stated (default: 0.5)")
    parser.add_argument("--output", metavar="FILE", help="write the result there too: a camera_info file, or the part "
                                                         "of a scenario")
    parser.add_argument("--report", metavar="FILE", help="write a page of the values and residuals there")


def _calibrate(arguments: Namespace) -> int:
    if not arguments.z_star_m > 0.0:
        raise ParameterError(f"--z-star-m: found {arguments.z_star_m:g}, allowed > 0")
    board = Board(arguments.board, arguments.columns, arguments.rows, arguments.size_m)
    found = CALIBRATIONS.find(arguments.what)(Request(
        board, tuple(arguments.files), arguments.model, arguments.camera, arguments.scenario, arguments.link,
        arguments.z_star_m))
    check = check_residuals(found, board)
    document = found.document if isinstance(found.document, str) else yaml.safe_dump(found.document, sort_keys=False)
    _tell(found, check)
    print(document.rstrip())
    if arguments.output:
        Path(arguments.output).write_text(document, encoding="utf-8")
    if arguments.report:
        page = study("report.calibration").calibration_html(
            f"Calibration: {arguments.what}", arguments.repeat, found.values, found.unknown,
            list(zip(found.names, found.view_residuals_px)), found.residual_px, check.expected_px,
            verdict(found, check), check.fits is not False, found.cost, found.cost_unit, document)
        Path(arguments.report).write_text(page, encoding="utf-8")
    return cli.EXIT_PASSED


def verdict(found: Calibrated, check: ResidualCheck) -> str:
    """Returns the interpretation of the residual, in one sentence."""
    if check.fits is None:
        return "the board has too few points to tell the noise of the images"
    times = f"the residual is {check.times:.2f} times the one expected from the noise of the points"
    return times if check.fits else f"{times}: look for {found.advice}"


def _tell(found: Calibrated, check: ResidualCheck) -> None:
    for name in found.left_out:
        print(f"# {name}: the board is not wholly in view, left out")
    for each in found.values:
        print(f"# {each.name}: {each.value:.6g} +- {each.stddev:.2g} {each.unit}")
    for name, reason in found.unknown:
        print(f"# {name}: {reason}")
    worst = int(np.argmax(found.view_residuals_px))
    print(f"# residual {found.residual_px:.3f} px over {len(found.names)} views, the worst "
          f"{found.view_residuals_px[worst]:.3f} px in {found.names[worst]}")
    print(f"# expected {check.expected_px:.3f} px; {verdict(found, check)}")
    print(f"# error at the goal, one standard deviation {found.cost_unit}".rstrip())
    for what, value in found.cost.items():
        print(f"#   {what}: {value:.3g}")


VERBS = {"calibrate": cli.Command(
    "Calibrate a camera, its place on the arm, offsets of the joints, or the target's plane, from images of a "
    "chessboard or of a grid of circles. Every result has its residual, the residual expected from noise, and the "
    "error that it causes at the goal.",
    [(f"camera images/*.png {BOARD} --output camera.yaml", "the intrinsics, as camera_info_url reads them"),
     (f"hand_eye samples.yaml --camera camera.yaml --scenario my_arm.yaml --link flange {BOARD}",
      "where the camera is on its link, for robot.hand_eye"),
     (f"joint_offsets samples.yaml --camera camera.yaml --scenario ur5e --link tool0 {BOARD}",
      "the same with the offsets of the joints, for robot.joint_offsets"),
     (f"eye_to_hand samples.yaml --camera camera.yaml --scenario my_arm.yaml --link flange {BOARD}",
      "where a camera stands that sees the board in the hand, for robot.hand_eye and robot.target_link"),
     (f"target at_goal.png --camera camera.yaml {BOARD}", "depth and normal of the plane that the board is on")],
    _options, _calibrate)}
