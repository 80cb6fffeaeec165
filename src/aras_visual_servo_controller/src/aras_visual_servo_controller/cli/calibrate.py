"""The verb `calibrate camera | hand_eye | eye_to_hand | target`: what a real arm needs, from images of a board."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence, Tuple, Union

import numpy as np
import yaml

import aras_visual_servo as avs
from aras_visual_servo import ParameterError, cli, is_number, load_scenario, robot_kinematics
from aras_visual_servo.spatial import inverse
from ..calibration.boards import KINDS, Board
from ..calibration.camera import MODELS

BOARD = "--columns 8 --rows 5 --size-m 0.03"


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("what", choices=tuple(_WORK), help="what to calibrate")
    parser.add_argument("files", nargs="+", metavar="FILE",
                        help="camera: images of the board; hand_eye, eye_to_hand: a YAML list of {image: FILE, joints: "
                             "{NAME: POSITION}}; target: one image")
    parser.add_argument("--board", choices=KINDS, default=KINDS[0],
                        help="a chessboard (default), or OpenCV's asymmetric grid of circles")
    parser.add_argument("--columns", type=int, required=True, help="inner corners, or circles, in a row")
    parser.add_argument("--rows", type=int, required=True, help="rows of them; with a chessboard columns + rows is odd")
    parser.add_argument("--size-m", type=float, required=True,
                        help="side of a square, or distance of rows of circles [m]")
    parser.add_argument("--model", choices=tuple(MODELS), default="plumb_bob",
                        help="camera: model of its lens; equidistant is for fisheye lenses (default: plumb_bob)")
    parser.add_argument("--camera", metavar="FILE", help="all but camera: the file that `calibrate camera` wrote")
    parser.add_argument("--scenario", help="hand_eye, eye_to_hand: the scenario with the arm: robot.urdf and "
                                           "robot.base_link")
    parser.add_argument("--link", help="hand_eye: the link that carries the camera; eye_to_hand: the link that carries "
                                       "the board")
    parser.add_argument("--z-star-m", type=float, default=0.5, metavar="M",
                        help="depth of the target at the goal, for what the error costs there (default: 0.5)")
    parser.add_argument("--output", metavar="FILE", help="write the result there too: a camera_info file, or the part "
                                                         "of a scenario")


def _calibrate(arguments: Namespace) -> int:
    if not arguments.z_star_m > 0.0:
        raise ParameterError(f"--z-star-m: found {arguments.z_star_m:g}, allowed > 0")
    board = Board(arguments.board, arguments.columns, arguments.rows, arguments.size_m)
    result = _WORK[arguments.what](arguments, board)
    print(result.rstrip())
    if arguments.output:
        Path(arguments.output).write_text(result, encoding="utf-8")
    return cli.EXIT_PASSED


def _camera(arguments: Namespace, board: Board) -> str:
    from ..calibration.camera import calibrate_camera
    images = [_image(path) for path in arguments.files]
    sizes = {image.shape[1::-1] for image in images}
    if len(sizes) != 1:
        raise ParameterError(f"images: found sizes {sorted(sizes)}, allowed one size")
    names, views = _found(arguments.files, images, board)
    camera = calibrate_camera(views, board, sizes.pop(), arguments.model)
    fx, fy, cx, cy = camera.intrinsics[:4]
    s_fx, s_fy, s_cx, s_cy = camera.stddev[:4]
    print(f"# fx {fx:.2f} +- {s_fx:.2f}, fy {fy:.2f} +- {s_fy:.2f}, cx {cx:.2f} +- {s_cx:.2f}, "
          f"cy {cy:.2f} +- {s_cy:.2f} px")
    _residual(camera.residual_px, names, camera.view_residuals_px)
    _cost(camera.cost(arguments.z_star_m), f"mm, at {arguments.z_star_m:g} m")
    return camera.as_yaml()


def _hand_eye(arguments: Namespace, board: Board) -> str:
    _, names, poses, views = _arm_and_views(arguments, board)
    return _place(arguments, board, names, poses, views, {}, arguments.link)


def _eye_to_hand(arguments: Namespace, board: Board) -> str:
    scenario, names, poses, views = _arm_and_views(arguments, board)
    return _place(arguments, board, names, list(map(inverse, poses)), views, {"target_link": arguments.link},
                  scenario.robot["base_link"])


def _arm_and_views(arguments: Namespace, board: Board) -> Tuple[avs.Scenario, List[str], List[np.ndarray], List[Any]]:
    """(scenario, names, poses of --link in the base, views) of the samples in which the board is."""
    for key in ("scenario", "link"):
        if not getattr(arguments, key):
            raise ParameterError(f"--{key}: found nothing, `calibrate {arguments.what}` needs it")
    scenario, samples = load_scenario(arguments.scenario), _samples(arguments.files)
    arm = robot_kinematics(scenario.urdf_xml(), scenario.robot["base_link"], arguments.link)
    faults = [fault for sample in samples for fault in _joint_faults(arm, sample)]
    if faults:
        raise ParameterError(faults)
    by_name = {str(sample["image"]): arm.pose(arm.vector({name: float(sample["joints"][name])
                                                          for name in arm.joint_names})) for sample in samples}
    names, views = _found(list(by_name), [_image(name) for name in by_name], board)
    return scenario, names, [by_name[name] for name in names], views


def _joint_faults(arm: Any, sample: Dict[str, Any]) -> Iterator[str]:
    for name, low, high in zip(arm.joint_names, arm.lower, arm.upper):
        key, position = f"{sample['image']}: joints.{name}", sample["joints"].get(name)
        if position is None:
            yield f"{key}: missing"
        elif not is_number(position):
            yield f"{key}: found {position!r}, allowed a finite number"
        elif not low <= position <= high:
            yield f"{key}: found {position:g}, allowed {low:g} to {high:g}, the limits of the URDF (rad, not degrees)"


def _place(arguments: Namespace, board: Board, names: List[str], poses: List[np.ndarray], views: List[Any],
           robot: Dict[str, Any], link: str) -> str:
    from ..calibration.hand_eye import calibrate_hand_eye
    found = calibrate_hand_eye(poses, views, board, _camera_of(arguments), names)
    _residual(found.residual_px, names, found.view_residuals_px)
    _cost(found.cost(arguments.z_star_m), f"mm, at {arguments.z_star_m:g} m")
    return yaml.safe_dump({"robot": {**robot, "hand_eye": {
        "link": link, "position_m": [float(round(value, 6)) for value in found.X_FC[:3, 3]],
        "rpy_rad": [float(round(value, 6)) for value in found.rpy_rad]}}}, sort_keys=False)


def _target(arguments: Namespace, board: Board) -> str:
    from ..calibration.target import target_plane
    if len(arguments.files) != 1:
        raise ParameterError(f"target: found {len(arguments.files)} images, allowed one, at the goal")
    names, (view,) = _found(arguments.files, [_image(path) for path in arguments.files], board)
    found = target_plane(view, board, _camera_of(arguments))
    _residual(found.residual_px, names, (found.residual_px,))
    _cost(found.cost(), "")
    return yaml.safe_dump({"servo": {"target_normal_C": [float(round(value, 6)) for value in found.normal_C]},
                           "experiment": {"z_star_m": float(round(found.z_star_m, 6))}}, sort_keys=False)


_WORK = {"camera": _camera, "hand_eye": _hand_eye, "eye_to_hand": _eye_to_hand, "target": _target}


def _image(path: Union[str, Path]) -> np.ndarray:
    import cv2
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise ParameterError(f"{path}: found no image that OpenCV can read")
    return image


def _found(names: Sequence[str], images: Sequence[np.ndarray], board: Board) -> Tuple[List[str], List[Any]]:
    """(names, views) of the images in which the board is; the others are named."""
    views = [board.find(image) for image in images]
    for name, view in zip(names, views):
        if view is None:
            print(f"# {name}: the board is not wholly in view, left out")
    seen = [(name, view) for name, view in zip(names, views) if view is not None]
    if not seen:
        raise ParameterError(f"images: found the board in none of {len(images)}; are columns and rows those of inner "
                             "corners, not of squares?")
    return [name for name, _ in seen], [view for _, view in seen]


def _camera_of(arguments: Namespace) -> Any:
    from ..calibration.camera import CameraCalibration
    if not arguments.camera:
        raise ParameterError(f"--camera: found nothing, `calibrate {arguments.what}` needs the file that `calibrate "
                             "camera` wrote")
    return CameraCalibration.from_yaml(Path(arguments.camera).read_text(encoding="utf-8"), arguments.camera)


def _samples(files: Sequence[str]) -> List[Dict[str, Any]]:
    """List of {image, joints}; images are relative to the file that names them."""
    samples = []
    for file in map(Path, files):
        content = yaml.safe_load(file.read_text(encoding="utf-8"))
        for k, sample in enumerate(content if isinstance(content, list) else [content]):
            if not isinstance(sample, dict) or set(sample) != {"image", "joints"} or \
                    not isinstance(sample["joints"], dict):
                raise ParameterError(f"{file}: entry {k}: found {sample!r}, allowed image: FILE and joints: {{NAME: "
                                     "POSITION}}")
            samples.append({"image": file.parent / str(sample["image"]), "joints": sample["joints"]})
    return samples


def _residual(residual_px: float, names: Sequence[str], each: Sequence[float]) -> None:
    worst = max(range(len(names)), key=lambda k: each[k])
    print(f"# residual {residual_px:.3f} px over {len(names)} views, the worst {each[worst]:.3f} px in {names[worst]}")


def _cost(costs: Dict[str, float], unit: str) -> None:
    """One standard deviation of each."""
    print(f"# what the error costs at the goal, one standard deviation {unit}".rstrip())
    for what, value in costs.items():
        print(f"#   {what}: {value:.3g}")


VERBS = {"calibrate": cli.Command(
    "Calibrate a camera, its place on the arm, or the target's plane, from images of a chessboard or of a grid of "
    "circles. Every result comes with its residual and with what its error costs at the goal.",
    [(f"camera images/*.png {BOARD} --output camera.yaml", "the intrinsics, as camera_info_url reads them"),
     (f"hand_eye samples.yaml --camera camera.yaml --scenario my_arm.yaml --link flange {BOARD}",
      "where the camera is on its link, for robot.hand_eye"),
     (f"eye_to_hand samples.yaml --camera camera.yaml --scenario my_arm.yaml --link flange {BOARD}",
      "where a camera stands that sees the board in the hand, for robot.hand_eye and robot.target_link"),
     (f"target at_goal.png --camera camera.yaml {BOARD}", "depth and normal of the plane that the board is on")],
    _options, _calibrate)}
