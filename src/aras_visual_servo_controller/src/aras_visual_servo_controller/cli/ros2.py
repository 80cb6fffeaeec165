"""The verb `ros2 relay | run`."""

import argparse
import os
import signal
from argparse import ArgumentParser, Namespace

from aras_visual_servo import ArasError, ParameterError, cli
from ..nodes.graph import Graph
from ..nodes.launch import NAMESPACE
from ..ros2 import environment
from .over_ros import check


def _relay_options(parser: ArgumentParser) -> None:
    parser.add_argument("--namespace", default=NAMESPACE, metavar="NAME",
                        help=f"namespace of the simulator whose topics are relayed (default: {NAMESPACE})")


def _relay(arguments: Namespace) -> int:
    check(Namespace(namespace=arguments.namespace, split=None))  # of the shell, too
    environment.find_environment()
    uri = os.environ.get("ROS_MASTER_URI", "http://localhost:11311")
    if not Graph("/ros2", uri).master_answers():
        raise ArasError(f"ROS_MASTER_URI={uri}: no master answers there; start a simulator first, for example "
                        "`roslaunch aras_visual_servo_controller servo.launch experiment:=false`")
    os.environ["ROS_NAMESPACE"] = "/" + arguments.namespace.strip("/")  # before rospy is imported
    from ..ros2.relay import main
    return main()


def _run_options(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=cli.file, metavar="NODE.py", help="program with an rclpy node")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="its arguments")


def _run(arguments: Namespace) -> int:
    environment.check_shell(os.environ)
    if not os.path.isfile(arguments.file):
        raise ParameterError(f"NODE.py: found no file {arguments.file}")
    process = environment.start([arguments.file, *arguments.arguments], os.environ)
    try:
        code = process.wait()
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        process.wait()
        raise
    return code if code >= 0 else cli.EXIT_BROKEN


VERBS = {"ros2": {
    "relay": cli.Command(
        "Relay topics, services and the action `servo` of a running simulator to ROS 2 nodes of this machine.",
        [("", "for the simulator in /aras_visual_servo"), ("--namespace left", "for another one")],
        _relay_options, _relay),
    "run": cli.Command(
        "Run a program with an rclpy node in the ROS 2 environment that `script/bootstrap --ros2` made.",
        [("my_servo.py", "a node of your own"), ("my_servo.py --ros-args -r __node:=left", "with arguments of ROS 2")],
        _run_options, _run)}}
