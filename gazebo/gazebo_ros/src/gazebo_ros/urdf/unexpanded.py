"""Documents that xacro was to expand and did not, or did not as a whole."""
import xml.etree.ElementTree as ElementTree

from aras_visual_servo_sim import ModelError

XACRO = "{http://www.ros.org/wiki/xacro}", "{http://wiki.ros.org/xacro}", "{http://ros.org/wiki/xacro}"
#: Children of <robot>; everything else may be the call of a macro.
KNOWN = {"link", "joint", "gazebo", "transmission", "material", "sensor", "model", "static", "plugin", "author",
         "safety_controller", "ros2_control", "group_state", "group", "end_effector", "disable_collisions", "verbose"}


def require_expanded(robot: ElementTree.Element) -> None:
    """Raises: ModelError: the document has tags of xacro, or joints of links that are not there beside unknown tags,
    the remains of macros called without their prefix."""
    tags = [each.tag for each in robot.iter() if isinstance(each.tag, str) and each.tag.startswith(XACRO)]
    if tags:
        raise ModelError("SpawnModel: Failure - found <xacro:%s>, allowed is a URDF: the document is a xacro file, "
                         "expand it with `rosrun xacro xacro FILE`" % tags[0].rpartition("}")[2])
    links = {link.get("name") for link in robot.findall("link")}
    missing = sorted({end.get("link") for joint in robot.findall("joint")
                      for end in (*joint.findall("parent"), *joint.findall("child"))
                      if end.get("link") and end.get("link") not in links})
    unknown = sorted({each.tag for each in robot if isinstance(each.tag, str) and each.tag not in KNOWN})
    if missing and unknown:
        raise ModelError("SpawnModel: Failure - found no link '%s' and the unknown tag <%s>: if it calls a macro of "
                         "xacro, it needs the prefix, <xacro:%s>" % ("', '".join(missing), unknown[0], unknown[0]))
