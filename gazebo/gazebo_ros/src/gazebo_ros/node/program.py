"""The programs gzserver and gazebo: the node `gazebo` with the command line of Gazebo's server."""
import argparse
import sys

import rospy

from ..world.world import WorldSettings
from .server import CLOCK_RATE_HZ, Server

#: Options that Gazebo's server takes, and that change nothing here.
WITHOUT_EFFECT = ("-e", "--physics", "-r", "--record", "--verbose", "--lockstep", "-q", "--quiet", "-s",
                  "--server-plugin", "-g", "--gui-plugin", "--seed", "--iters", "--minimal_comms", "-o", "--profile",
                  "--record_path", "--record_encoding", "--record_period", "--record_filter", "--record_resources",
                  "--play", "-p", "--initial_sim_time")
WITH_VALUE = {"-e", "--physics", "-s", "--server-plugin", "-g", "--gui-plugin", "--seed", "--iters", "-o", "--profile",
              "--record_path", "--record_encoding", "--record_period", "--record_filter", "--play", "-p",
              "--initial_sim_time"}


def parsed(arguments):
    """(world file or "", paused, what is ignored) of a command line."""
    parser = argparse.ArgumentParser(prog="gzserver", description="The simulator under the name of Gazebo's server.")
    parser.add_argument("-u", "--pause", action="store_true", help="time stands still at first")
    parser.add_argument("world", nargs="?", default="", help="a .world file; what is read of it is in from_gazebo.md")
    for option in WITHOUT_EFFECT:
        parser.add_argument(option, nargs=1 if option in WITH_VALUE else 0, help="has no effect",
                            action="store" if option in WITH_VALUE else Ignored)
    known, others = parser.parse_known_args(arguments)
    return known.world, known.pause, others


class Ignored(argparse.Action):
    """An option without value and without effect."""

    def __call__(self, *_):
        pass


def main():
    world, paused, others = parsed(rospy.myargv()[1:])
    rospy.init_node("gazebo", disable_signals=False)
    for other in others:
        rospy.logwarn("option %s has no effect" % other)
    try:
        settings, static_models = world_of(world)
    except OSError as error:
        rospy.logfatal("gzserver: %s" % error)
        return 1
    rate_hz = rospy.get_param("/gazebo/pub_clock_frequency", CLOCK_RATE_HZ)
    Server(settings, paused, rate_hz if rate_hz > 0 else CLOCK_RATE_HZ, static_models).run()
    return 0


def world_of(name):
    """WorldSettings and names of the models of a world file."""
    if name in ("", "worlds/empty.world", "empty.world"):
        return WorldSettings(), ["ground_plane"]
    rospy.logwarn("world %s is not read: the world is empty but for a ground plane and the sun" % name)
    return WorldSettings(), ["ground_plane"]


if __name__ == "__main__":
    sys.exit(main())
