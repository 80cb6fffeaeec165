"""The kinematics of whatever robot a URDF describes, with the camera where the URDF or a calibration has it."""

from functools import lru_cache
from typing import Any, Mapping, Optional
from xml.etree import ElementTree

import numpy as np

from ..config.reader import read
from ..ground.errors import ModelError
from ..spatial import rotation, rpy_of, transform
from .free_camera import FreeCamera, joints_above, origin_pose
from .kinematics import EyeToHand, Kinematics, RobotKinematics
from .settings import HandEyeSettings

#: Link that stands for the optical frame of a calibrated camera.
CALIBRATED_LINK = "hand_eye_optical_frame"


@lru_cache(maxsize=8)  # runs of a sweep share one object, which is never changed: reading a URDF takes a millisecond
def robot_kinematics(urdf_xml: str, base_link: str, tip_link: str,
                     target_link: Optional[str] = None) -> RobotKinematics:
    """Makes an `EyeToHand` if a link carries the target, a `FreeCamera` if a floating joint carries the tip, else
    `Kinematics`.

    Raises ModelError: bad URDF, unknown link, tip not below base, joint types that cannot be represented.
    """
    if target_link is not None:
        return EyeToHand(urdf_xml, base_link, tip_link, target_link)
    if any(joint.get("type") == "floating" for joint in joints_above(urdf_xml, base_link, tip_link)):
        return FreeCamera(urdf_xml, base_link, tip_link)
    return Kinematics(urdf_xml, base_link, tip_link)


def kinematics_of(urdf_xml: str, robot: Mapping[str, Any], calibrated: bool = True) -> RobotKinematics:
    """Makes the `robot_kinematics` of a scenario's section `robot`.

    Args: calibrated: to where hand_eye has the camera, with the joint_offsets, as far as the section has them; else to
        its tip_link.
    Raises ModelError, ParameterError.
    """
    target_link = robot.get("target_link")
    if robot.get("joint_offsets") and calibrated:
        urdf_xml = with_joint_offsets(urdf_xml, robot["joint_offsets"])
    if robot.get("hand_eye") is None or not calibrated:
        return robot_kinematics(urdf_xml, robot["base_link"], robot["tip_link"], target_link)
    hand_eye = read(HandEyeSettings, robot["hand_eye"], "robot.hand_eye")
    return robot_kinematics(with_camera(urdf_xml, hand_eye), robot["base_link"], CALIBRATED_LINK, target_link)


def with_joint_offsets(urdf_xml: str, offsets: Mapping[str, float]) -> str:
    """Returns the URDF whose joints are at their true places at the positions that the arm reports.

    Args: offsets: joint -> true minus reported position [m or rad].  Raises ModelError.
    """
    robot = _parsed(urdf_xml)
    joints = {joint.get("name"): joint for joint in robot.findall("joint")}
    for name, offset in offsets.items():
        if name not in joints:
            raise ModelError(f"robot.joint_offsets.{name}: found no such joint in the URDF")
        joint, axis = joints[name], joints[name].find("axis")
        along = np.array(("1 0 0" if axis is None else axis.get("xyz", "1 0 0")).split(), dtype=float)
        along *= float(offset) / np.linalg.norm(along)
        slides = joint.get("type") == "prismatic"
        moved = transform(np.eye(3), along) if slides else transform(rotation(along), np.zeros(3))
        X, origin = origin_pose(joint) @ moved, joint.find("origin")
        if origin is None:
            origin = ElementTree.SubElement(joint, "origin")
        origin.set("xyz", " ".join(map(repr, X[:3, 3].tolist())))
        origin.set("rpy", " ".join(map(repr, map(float, rpy_of(X[:3, :3])))))
    return ElementTree.tostring(robot, encoding="unicode")


def with_camera(urdf_xml: str, hand_eye: HandEyeSettings) -> str:
    """Returns the URDF with one more link, CALIBRATED_LINK, at the calibrated camera. Raises ModelError."""
    robot = _parsed(urdf_xml)
    if hand_eye.link not in (link.get("name") for link in robot.findall("link")):
        raise ModelError(f"robot.hand_eye.link: found {hand_eye.link}, allowed a link of the URDF")
    ElementTree.SubElement(robot, "link", name=CALIBRATED_LINK)
    joint = ElementTree.SubElement(robot, "joint", name=CALIBRATED_LINK + "_joint", type="fixed")
    ElementTree.SubElement(joint, "parent", link=hand_eye.link)
    ElementTree.SubElement(joint, "child", link=CALIBRATED_LINK)
    ElementTree.SubElement(joint, "origin", xyz=" ".join(map(repr, map(float, hand_eye.position_m))),
                           rpy=" ".join(map(repr, map(float, hand_eye.rpy_rad))))
    return ElementTree.tostring(robot, encoding="unicode")


def _parsed(urdf_xml):
    try:
        return ElementTree.fromstring(urdf_xml)
    except ElementTree.ParseError as error:
        raise ModelError(f"the URDF is no XML: {error}") from error
