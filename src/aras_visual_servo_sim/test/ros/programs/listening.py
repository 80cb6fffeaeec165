#!/usr/bin/env python3
"""Waiting for what comes over ROS, for the tests beside this file."""
import time
import xmlrpc.client

import rosgraph
import rospy
from sensor_msgs.msg import JointState

LIMIT_S = 30.0  # wall time after which something that should happen has not


def until(condition, what):
    """Value of condition() once it is true."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.005)
    raise AssertionError("never happened: " + what)


def until_sent_to(*subscribers):
    """Waits until whatever is published from now on comes to these rospy.Subscribers.

    The publishers are asked whether they send to this node: rospy counts a connection that is yet to be made.
    """
    master = rosgraph.Master(rospy.get_name())

    def sends(node, topic):
        _, _, connections = xmlrpc.client.ServerProxy(master.lookupNode(node)).getBusInfo(rospy.get_name())
        return any(to == rospy.get_name() and direction == "o" and name == topic
                   for _, to, direction, _, name, *_ in connections)

    def stands(topic):
        publishers = dict(master.getSystemState()[0]).get(topic, [])
        return publishers and all(sends(node, topic) for node in publishers)

    for subscriber in subscribers:
        until(lambda topic=subscriber.resolved_name: stands(topic), "the subscription of " + subscriber.resolved_name)


class Listener:
    """Keeps every message of a topic."""

    def __init__(self, topic, kind):
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.messages.append, queue_size=1000, tcp_nodelay=True)

    def wait(self, count=1):
        until(lambda: len(self.messages) >= count, "%d messages on %s" % (count, self.subscriber.resolved_name))
        return list(self.messages)

    def newer(self, condition, what):
        """A message that fulfils the condition and comes after this call."""
        start = len(self.messages)
        return until(lambda: next((m for m in self.messages[start:] if condition(m)), None), what)

    def later(self, stamp, what):
        """The last message, once there is one that is stamped later than this. It may have come before this call."""
        return until(lambda: [m for m in list(self.messages) if m.header.stamp > stamp], what)[-1]

    def at(self, stamp, what):
        """The message with this stamp, once it is there: what comes over another connection may be behind."""
        return until(lambda: next((m for m in list(self.messages) if m.header.stamp == stamp), None), what)

    def stamps(self):
        return [message.header.stamp.to_nsec() for message in list(self.messages)]


def service(name, kind):
    rospy.wait_for_service(name, LIMIT_S)
    return rospy.ServiceProxy(name, kind)


def command_publisher(topic="joint_command", kind=JointState):
    publisher = rospy.Publisher(topic, kind, queue_size=100, tcp_nodelay=True)
    until(publisher.get_num_connections, "the simulator subscribes to " + topic)
    return publisher


def command(stamp, **velocities):
    message = JointState(name=list(velocities), velocity=list(velocities.values()))
    message.header.stamp = stamp
    return message
