"""A node that asks other nodes what a test wants to know, as `rosservice call` and `rostopic echo -n 1` do, without the
second that each of these takes to start. `ros_graph.Graph` starts it: a line of JSON in, [kind, name, request], and one
out, [answer as YAML, or None; what went wrong]."""
import json
import sys

import genpy
import rosgraph
import rospy
import rosservice
import rostopic
import yaml
from ros_graph import LIMIT_S, until


def call(service, request):
    """The answer of a service; request: YAML, or an empty text."""
    kind = rosservice.get_service_class_by_name(service)
    filled = kind._request_class()
    genpy.message.fill_message_args(filled, [yaml.safe_load(request)] if request else [])
    return rospy.ServiceProxy(service, kind)(filled)


def message(topic, _):
    """The next message of a topic."""
    kind = until(lambda: rostopic.get_topic_class(topic)[0], "a topic " + topic)
    return rospy.wait_for_message(topic, kind, LIMIT_S)


def main():
    """Answer until nobody asks any more."""
    until(rosgraph.is_master_online, "a master")  # without one, init_node waits for ever
    # Wall time: it need not listen to a clock of a thousand ticks a second.
    rospy.impl.simtime.init_simtime = lambda: True
    rospy.rostime.set_rostime_initialized(True)
    rospy.init_node("asker", anonymous=True, disable_rosout=True, disable_signals=True)
    for line in sys.stdin:
        kind, name, request = json.loads(line)
        try:
            told = [genpy.message.strify_message({"call": call, "message": message}[kind](name, request)), ""]
        except Exception as error:  # whoever asks is told, whatever it is
            told = [None, f"{name}: {type(error).__name__}: {error}"]
        print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main()
