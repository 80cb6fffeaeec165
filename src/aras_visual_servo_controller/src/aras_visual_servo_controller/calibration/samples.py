"""Reads what calibrations work on: images of the board, and lists of samples with joint positions."""

from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence, Tuple, Union

import numpy as np
import yaml

import aras_visual_servo as avs
from aras_visual_servo import ParameterError, is_number, load_scenario, robot_kinematics
from .boards import Board
from .family import Request

#: What the files of a calibration with the arm are.
FILES = "YAML lists of {image: FILE, joints: {NAME: POSITION}}"


def image_of_file(path: Union[str, Path]) -> np.ndarray:
    """Returns a grey image, (h, w) uint8. Raises ParameterError: OpenCV cannot read it."""
    import cv2
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise ParameterError(f"{path}: found no image that OpenCV can read")
    return image


def found_views(names: Sequence[str], images: Sequence[np.ndarray],
                board: Board) -> Tuple[Tuple[str, ...], List[np.ndarray], Tuple[str, ...]]:
    """Returns (names, views (n, 2) px, names left out): the images in which the board is, and those in which it is not.

    Raises ParameterError: the board is in none.
    """
    views = [board.find(image) for image in images]
    seen = [(str(name), view) for name, view in zip(names, views) if view is not None]
    if not seen:
        raise ParameterError(f"images: found the board in none of {len(images)}; are columns and rows those of inner "
                             "corners, not of squares?")
    return (tuple(name for name, _ in seen), [view for _, view in seen],
            tuple(str(name) for name, view in zip(names, views) if view is None))


class ArmSamples:
    """Views of the board with the joint positions of the arm.

    Attributes:
        scenario: of the arm.  arm: kinematics from robot.base_link to `link`.  names: of the views.
        joints: (k, n) positions in the order of arm.joint_names.  poses: list of X_BF of the link.
        views: list of (n, 2) px.  left_out: names of images without the board.
    Raises: ParameterError: a file or a joint that is missing, no number or beyond its limits, each of them.
    """

    def __init__(self, request: Request) -> None:
        missing = [f"--{key}: found nothing, allowed {what}" for key, what in (
            ("scenario", "the scenario of the arm"), ("link", "a link of the arm")) if not getattr(request, key)]
        if missing:
            raise ParameterError(missing)
        self.scenario: avs.Scenario = load_scenario(request.scenario)
        samples = read_samples(request.files)
        self.arm = robot_kinematics(self.scenario.urdf_xml(), self.scenario.robot["base_link"], request.link)
        faults = [fault for sample in samples for fault in joint_faults(self.arm, sample)]
        if faults:
            raise ParameterError(faults)
        by_name = {str(sample["image"]): self.arm.vector({name: float(sample["joints"][name])
                                                          for name in self.arm.joint_names}) for sample in samples}
        self.names, self.views, self.left_out = found_views(
            list(by_name), [image_of_file(name) for name in by_name], request.board)
        self.joints = np.array([by_name[name] for name in self.names])
        self.poses = [self.arm.pose(q) for q in self.joints]


def joint_faults(arm: Any, sample: Dict[str, Any]) -> Iterator[str]:
    """Yields a text for each joint of a sample that is missing, no number or beyond its limits."""
    for name, low, high in zip(arm.joint_names, arm.lower, arm.upper):
        key, position = f"{sample['image']}: joints.{name}", sample["joints"].get(name)
        if position is None:
            yield f"{key}: missing"
        elif not is_number(position):
            yield f"{key}: found {position!r}, allowed a finite number"
        elif not low <= position <= high:
            yield f"{key}: found {position:g}, allowed {low:g} to {high:g}, the limits of the URDF (rad, not degrees)"


def read_samples(files: Sequence[str]) -> List[Dict[str, Any]]:
    """Returns a list of {image, joints}; images are relative to the file that names them. Raises ParameterError."""
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
