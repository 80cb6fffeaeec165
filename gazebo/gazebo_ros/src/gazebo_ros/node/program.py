"""The programs gzserver and gazebo: the node `gazebo` with the command line of Gazebo's server."""
import argparse
import typing

import rospy

from ..faults import REFUSED
from ..sdf.document import NoFolders
from ..sdf.world import EMPTY_WORLD, WorldFile, read_world
from .folders import Folders
from .server import CLOCK_RATE_HZ, Server

#: Of the world that has nothing but the ground and the sun, which Gazebo has under these names.
EMPTY = ("", "worlds/empty.world", "empty.world")
NOT_THERE = 255  #: exit code of Gazebo's server when there is no such world

#: Options that Gazebo's server takes, without and with a value, and that change nothing here.
FLAGS = ("-r", "--record", "--verbose", "--lockstep", "-q", "--quiet", "--minimal_comms", "--record_resources")
WITH_VALUE = ("-e", "--physics", "-s", "--server-plugin", "-g", "--gui-plugin", "--seed", "--iters", "-o", "--profile",
              "--record_path", "--record_encoding", "--record_period", "--record_filter", "--play", "-p",
              "--initial_sim_time")


def parsed(arguments: typing.Sequence[str]) -> typing.Tuple[str, bool, typing.List[str]]:
    """Returns (world file or "", paused, ignored arguments) of a command line."""
    parser = argparse.ArgumentParser(prog="gzserver", description="The simulator under the name of Gazebo's server.")
    parser.add_argument("-u", "--pause", action="store_true", help="time stands still at first")
    parser.add_argument("world", nargs="?", default="",
                        help="a .world file; docs/from_gazebo_reference.md lists the elements read")
    for option in FLAGS + WITH_VALUE:
        parser.add_argument(option, action="store_true" if option in FLAGS else "store", help="has no effect")
    known, others = parser.parse_known_args(arguments)
    return known.world, known.pause, others


def main() -> int:
    world, paused, others = parsed(rospy.myargv()[1:])
    rospy.init_node("gazebo", disable_signals=False)
    for other in others:
        rospy.logwarn("option %s has no effect" % other)
    folders = Folders()
    try:
        file = world_of(world, folders)
    except NoSuchWorldError as error:
        rospy.logfatal("gzserver: %s" % error)
        return NOT_THERE
    except Exception as error:  # of libsdformat or Python as well: a world that cannot be read is an empty one
        rospy.logerr("gzserver: %s: %s: the world is empty" % (world, str(error).replace(REFUSED, "")))
        file = read_world(EMPTY_WORLD, False, folders)
    rate_hz = rospy.get_param("/gazebo/pub_clock_frequency", CLOCK_RATE_HZ)
    server = Server(file.settings, folders, paused, rate_hz if rate_hz > 0 else CLOCK_RATE_HZ)
    server.fill(file)
    server.run()
    return 0


class NoSuchWorldError(Exception):
    """There is no file of this name."""


def world_of(name: str, folders: NoFolders) -> WorldFile:
    """WorldFile of a name. Raises: NoSuchWorldError, ModelError."""
    path = folders.resource(name)
    if path is not None:
        return read_world(path, True, folders)
    if name in EMPTY:
        return read_world(EMPTY_WORLD, False, folders)
    raise NoSuchWorldError("Could not open file[%s]" % name)
