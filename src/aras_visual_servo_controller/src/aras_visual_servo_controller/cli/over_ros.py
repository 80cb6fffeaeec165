"""Options of `aras-servo run --ros`, and the run over roslaunch."""

import os
import re
from argparse import Namespace, _ArgumentGroup

from aras_visual_servo import ParameterError, Scenario
from ..bags.record_groups import COMPRESSIONS, GROUPS, ON_DEMAND, parse_groups
from ..ros2.environment import check_shell

NAMESPACE = re.compile(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)


def add_options(group: _ArgumentGroup) -> None:
    """Adds the options of a run over ROS."""
    group.add_argument("--record", metavar="GROUPS", help="groups of topics to record, e.g. images,features,truth for "
                       "these, --record=-images for all but images, or all,segmentation for one more; the groups are "
                       + ", ".join(GROUPS) + " (default: all), and, recorded only when named, " + ", ".join(ON_DEMAND))
    group.add_argument("--split", type=int, metavar="MB", help="begin a new bag file when one has reached this size")
    group.add_argument("--compression", choices=COMPRESSIONS, help="compression of the bag (default: lz4)")
    group.add_argument("--namespace", metavar="NAME", help="namespace of the graph, with a clock and frames of its "
                       "own, so that several runs share a master (default: aras_visual_servo, global clock)")
    group.add_argument("--ros2", action="store_true", help="relay topics, services and the action to ROS 2 nodes of "
                       "this machine (docs/ros2.md)")
    group.add_argument("--verbose", action="store_true", help="show the output of the nodes")


def check(arguments: Namespace) -> None:
    """Raises ParameterError: an option has a value that is not allowed."""
    if arguments.namespace is not None and not NAMESPACE.fullmatch(arguments.namespace):
        raise ParameterError(f"--namespace: found '{arguments.namespace}', allowed is a name of ROS, letters, digits "
                             "and _ with / between")
    check_shell(os.environ)
    if arguments.split is not None and arguments.split < 1:
        raise ParameterError(f"--split: found {arguments.split}, allowed >= 1")


def run(scenario: Scenario, arguments: Namespace) -> int:
    """Runs a scenario over ROS. Returns the exit code."""
    from ..nodes.launch import run_over_ros
    given = {"record_groups": ",".join(parse_groups(arguments.record)) if arguments.record else None,
             "record_split_mb": arguments.split, "record_compression": arguments.compression,
             "video": "true" if arguments.video else None, "ros2": "true" if arguments.ros2 else None,
             "repeat": arguments.repeat}
    return run_over_ros(scenario, arguments.output, [f"{name}:={value}" for name, value in given.items() if value],
                        verbose=arguments.verbose, namespace=arguments.namespace)
