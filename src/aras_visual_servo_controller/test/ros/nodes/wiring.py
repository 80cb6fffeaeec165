"""Helpers of the wiring tests. Everything waits on a condition with a limit of wall time, never for a fixed time."""

import os
import threading
import time

import rospy
from actionlib_msgs.msg import GoalID
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty

from aras_visual_servo_controller.nodes.graph import Graph
from aras_visual_servo_msgs.msg import (
    MomentFeatures, ServoState, SimStatus, VisualServoActionFeedback, VisualServoActionGoal, VisualServoActionResult)

LIMIT_S = 60.0  # wall time until a condition must hold; generous, the machine may be busy


def wait_until(condition, what, limit_s=LIMIT_S):
    """The first true value of condition(); AssertionError naming `what` after limit_s of wall time."""
    deadline = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline or rospy.is_shutdown():
            raise AssertionError(f"waited {limit_s:g} s for: {what}")
        time.sleep(0.01)


class Watcher:
    """Keeps the messages of the controller's topics, by stamp [ns]."""

    def __init__(self):
        self.states, self.commands, self.features, self.joints = {}, {}, {}, {}
        self.sim = self.result = self.feedback = None
        self.goals = rospy.Publisher("servo/goal", VisualServoActionGoal, queue_size=1)
        self.cancels = rospy.Publisher("servo/cancel", GoalID, queue_size=1)
        self._of_controller = [rospy.Subscriber("servo_state", ServoState, self._keep, self.states),
                               rospy.Subscriber("joint_command", JointState, self._keep, self.commands)]
        rospy.Subscriber("joint_states", JointState, self._keep, self.joints)
        rospy.Subscriber("camera/features", MomentFeatures, self._keep, self.features)
        rospy.Subscriber("sim/status", SimStatus, lambda message: setattr(self, "sim", message))
        self._of_controller += [
            rospy.Subscriber("servo/result", VisualServoActionResult, lambda m: setattr(self, "result", m)),
            rospy.Subscriber("servo/feedback", VisualServoActionFeedback, lambda m: setattr(self, "feedback", m))]
        self._count = 0

    def connected(self):
        """Whether nothing that the controller says from now on is missed."""
        graph = Graph(rospy.get_name(), os.environ["ROS_MASTER_URI"])
        published = {subscriber.resolved_name for subscriber in self._of_controller} <= set(graph.topics())
        return published and not graph.missing_connections([rospy.get_name(), rospy.resolve_name("controller")])

    @staticmethod
    def _keep(message, kept):
        kept[message.header.stamp.to_nsec()] = message

    @property
    def state(self):
        """The latest ServoState, or None."""
        states = dict(self.states)
        return states[max(states)] if states else None

    def send_goal(self, reference, **fields):
        """Send a goal; its result will be `result`. Returns its id."""
        wait_until(lambda: self.goals.get_num_connections() > 0, "an action server")
        self.result = None
        self._count += 1
        goal = VisualServoActionGoal()
        goal.goal_id.id = f"{rospy.get_name()}-{self._count}"
        goal.goal.reference = reference
        for name, value in fields.items():
            setattr(goal.goal, name, value)
        self.goals.publish(goal)
        return goal.goal_id.id

    def wait_result(self, goal_id, limit_s=LIMIT_S):
        """The VisualServoActionResult of that goal."""
        return wait_until(lambda: self.result if self.result and self.result.status.goal_id.id == goal_id else None,
                          f"the result of {goal_id}", limit_s)

    def wait_phase(self, phase):
        """Wait until a ServoState is in that phase."""
        wait_until(lambda: self.state is not None and self.state.phase == phase, f"phase {phase}")

    def wait_connected(self):
        """Wait until the paused simulator, the camera and the controller are connected with each other."""
        graph = Graph(rospy.get_name(), os.environ["ROS_MASTER_URI"])
        nodes = [rospy.resolve_name(name) for name in ("sim", "camera_node", "controller")] + [rospy.get_name()]
        names = ("camera/features", "joint_states", "joint_command", "servo_state", "servo/result")
        topics = {rospy.resolve_name(name) for name in names}
        wait_until(lambda: topics <= set(graph.topics()), "the topics of the graph")
        wait_until(lambda: not graph.missing_connections(nodes), "the connections of the graph")
        wait_until(lambda: self.sim is not None, "sim/status")


def call(name, service_type=Empty, *arguments):
    """Call a service."""
    rospy.wait_for_service(name, LIMIT_S)
    return rospy.ServiceProxy(name, service_type)(*arguments)


class FakePlant:
    """Plays simulator and camera: an arm that stands still in front of a target, on wall time.

    Attributes:
        published: MomentFeatures by stamp [ns].  asked: requests of camera/set_reference, in order.
        answer_after_s: wall time until they are answered.  refusal: text that they are refused with, "": they are not.
    """

    def __init__(self, joint_names, set_reference_type):
        self._names = joint_names
        self._features_publisher = rospy.Publisher("camera/features", MomentFeatures, queue_size=100)
        self._joints_publisher = rospy.Publisher("joint_states", JointState, queue_size=100)
        self._service = rospy.Service("camera/set_reference", set_reference_type, self._on_set_reference)
        self._response = set_reference_type._response_class
        self._stop = threading.Event()
        self._thread = None
        self.published, self.asked = {}, []
        self.answer_after_s, self.refusal = 0.0, ""

    def connected(self):
        return self._features_publisher.get_num_connections() > 0 and self._joints_publisher.get_num_connections() > 0

    def _on_set_reference(self, request):
        self.asked.append(request)
        time.sleep(self.answer_after_s)
        return self._response(success=not self.refusal, message=self.refusal, stamp=request.stamp)

    @staticmethod
    def features(stamp, **changes):
        """Features of a target that is 0.05 m off in x, valid and with a reference."""
        message = MomentFeatures(target_visible=True, valid=True, has_reference=True, components=1, area=0.01, xg=0.1,
                                 yg=0.0, alpha=0.2, xn=0.05, yn=0.0, an=0.5, z_star_m=0.5, area_star=0.01)
        message.header.stamp, message.header.frame_id = stamp, "camera_optical_frame"
        for name, value in changes.items():
            setattr(message, name, value)
        message.xg, message.yg = message.xn / message.an, message.yn / message.an
        return message

    def publish(self, stamp=None, joints=True, q=None, **changes):
        """One image and, unless joints is False, the joint state of the same stamp. Returns the stamp [ns]."""
        stamp = stamp or rospy.Time.now()
        if joints:
            message = JointState(name=self._names, position=q or [0.1] * len(self._names))
            message.header.stamp = stamp
            self._joints_publisher.publish(message)
        self.published[stamp.to_nsec()] = self.features(stamp, **changes)
        self._features_publisher.publish(self.published[stamp.to_nsec()])
        return stamp.to_nsec()

    def start(self, rate_hz=30.0, **changes):
        """Publish images with these features until stop(); a function gives the value by the number of the image."""
        self.stop()
        self._stop.clear()

        def loop():
            count = 0
            while not self._stop.wait(1.0 / rate_hz):
                self.publish(**{name: value(count) if callable(value) else value for name, value in changes.items()})
                count += 1
        self._thread = threading.Thread(target=loop, daemon=True)
        self._thread.start()

    def stop(self):
        """No more images."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
