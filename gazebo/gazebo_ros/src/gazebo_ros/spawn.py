"""The program spawn_model, with the options of gazebo_ros's."""
import argparse
import os
import pathlib
import sys
import typing
import xml.etree.ElementTree as ElementTree

import rospy
from gazebo_msgs.msg import ModelStates
from gazebo_msgs.srv import DeleteModel, SetModelConfiguration, SpawnModel
from std_srvs.srv import Empty

from .node.convert import pose_message
from .world.poses import matrix_of_rpy

LIMIT_S = 30.0  #: wall time until the simulator must be there


class RefusedError(Exception):
    """A request failed; the text has the reason."""


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(prog="spawn_model", description="Spawns a model.")
    form = made.add_mutually_exclusive_group(required=True)
    form.add_argument("-urdf", action="store_true", help="the description is a URDF")
    form.add_argument("-sdf", action="store_true", help="the description is an SDF")
    source = made.add_mutually_exclusive_group(required=True)
    source.add_argument("-file", metavar="FILE", help="file of the description")
    source.add_argument("-param", metavar="NAME", help="parameter that holds the description")
    source.add_argument("-database", metavar="MODEL", help="model of Gazebo's database")
    source.add_argument("-stdin", action="store_true", help="the description comes in from the standard input")
    made.add_argument("-model", required=True, metavar="NAME", help="name in the world")
    made.add_argument("-reference_frame", default="", metavar="NAME", help="model or link that the pose is relative to")
    made.add_argument("-gazebo_namespace", default="/gazebo", metavar="NS", help="where the simulator's services are")
    made.add_argument("-robot_namespace", default=rospy.get_namespace(), metavar="NS", help="of the model's plugins")
    made.add_argument("-unpause", action="store_true", help="lets time go on afterwards")
    made.add_argument("-wait", metavar="MODEL", help="waits until this model is there")
    for option, what in (("x", "position [m]"), ("y", "position [m]"), ("z", "position [m]"), ("R", "roll [rad]"),
                         ("P", "pitch [rad]"), ("Y", "yaw [rad]")):
        made.add_argument("-" + option, type=float, default=0.0, help=what)
    made.add_argument("-J", dest="joints", nargs=2, action="append", default=[], metavar=("JOINT", "POSITION"),
                      help="places a joint [m or rad]")
    made.add_argument("-package_to_model", action="store_true", help="package:// of meshes becomes model://")
    made.add_argument("-b", dest="bond", action="store_true", help="stays, and deletes the model when it ends")
    return made


def description(options: argparse.Namespace) -> str:
    """Text of the description. Raises: RefusedError."""
    if options.database:
        return "<sdf version='1.6'><include><uri>model://%s</uri></include></sdf>" % options.database
    if options.stdin:
        text = sys.stdin.read()
    elif options.param:
        text = rospy.get_param(options.param, "")
    elif os.path.isfile(options.file):
        text = pathlib.Path(options.file).read_text(encoding="utf-8", errors="replace")
    else:
        raise RefusedError("Error: specified file %s does not exist" % options.file)
    if not text:
        raise RefusedError("Error: the description is empty or does not exist")
    try:
        ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise RefusedError("Invalid XML: %s" % error) from error
    return text.replace("package://", "model://") if options.package_to_model else text


def call(name: str, kind: typing.Any, *request: typing.Any) -> typing.Any:
    """The answer of a service. Raises: RefusedError when it is not there, or says no."""
    try:
        rospy.wait_for_service(name, LIMIT_S)
        response = rospy.ServiceProxy(name, kind)(*request)
    except (rospy.ROSException, rospy.ServiceException) as error:
        raise RefusedError("%s: %s" % (name, error)) from error
    if not getattr(response, "success", True):
        raise RefusedError(response.status_message)
    return response


def spawn(options: argparse.Namespace) -> None:
    """Raises: RefusedError."""
    if options.wait:
        rospy.loginfo("Waiting for model %s before proceeding." % options.wait)
        while not rospy.is_shutdown():
            states = rospy.wait_for_message(options.gazebo_namespace + "/model_states", ModelStates)
            if options.wait in states.name:
                break
    pose = pose_message(matrix_of_rpy((options.x, options.y, options.z), (options.R, options.P, options.Y)))
    service = "/spawn_urdf_model" if options.urdf else "/spawn_sdf_model"
    call(options.gazebo_namespace + service, SpawnModel, options.model, description(options), options.robot_namespace,
         pose, options.reference_frame)
    if options.joints:
        call(options.gazebo_namespace + "/set_model_configuration", SetModelConfiguration, options.model, "",
             [name for name, _ in options.joints], [float(position) for _, position in options.joints])
    if options.unpause:
        call(options.gazebo_namespace + "/unpause_physics", Empty)


def main() -> int:
    options = parser().parse_args(rospy.myargv()[1:])
    rospy.init_node("spawn_model", anonymous=True)
    try:
        spawn(options)
    except RefusedError as error:
        rospy.logerr("%s\nSpawn service failed. Exiting." % error)
        return 1
    if options.bond:
        rospy.on_shutdown(lambda: rospy.ServiceProxy(options.gazebo_namespace + "/delete_model",
                                                     DeleteModel)(options.model))
        rospy.spin()
    return 0
