"""The kinematics of whatever robot a URDF describes."""

from .free_camera import FreeCamera, joints_above
from .kinematics import Kinematics


def robot_kinematics(urdf_xml: str, base_link: str, tip_link: str):
    """`FreeCamera` where a floating joint carries the tip, else `Kinematics`; both have the same interface.

    Raises ModelError: bad URDF, unknown link, tip not below base, joint types that cannot be represented.
    """
    if any(joint.get("type") == "floating" for joint in joints_above(urdf_xml, base_link, tip_link)):
        return FreeCamera(urdf_xml, base_link, tip_link)
    return Kinematics(urdf_xml, base_link, tip_link)
