#!/usr/bin/env python3
"""A detector's poses in, twists out: the loop closes over another node's features and another driver's kinematics."""
import sys
import threading
import time
import unittest

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped, TwistStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from aras_visual_servo import kinematics_of, spatial
from aras_visual_servo_msgs.srv import Teach
from wiring import Watcher, call, wait_until

PERIOD_S, IMAGE_TICKS, LIMIT_S = 0.01, 3, 60.0
#: Wall time in which a message arrives on an idle machine; an image waits a hundred times as long for its answer.
BREATH_S = 0.004
#: The servo's thresholds and the latency of a busy machine.
ARRIVED_M, ARRIVED_RAD = 1e-3, 2e-3
OFF = np.array([0.04, -0.03, 0.05, 0.05, -0.05, 0.15])


class Plant:
    """Joints that follow the twists that come, in two messages, and the pose of a target that the camera sees.

    It makes the time too: time goes on when the controller has answered the image, so a slow machine changes nothing.
    """

    def __init__(self, kinematics, q, frame_id, answers):
        self.kinematics, self.q, self.twists = kinematics, np.array(q), []
        self.X_WT = kinematics.pose(self.q) @ spatial.pose_from_rpy([0.02, -0.01, 0.5], [np.pi - 0.1, 0.1, 0.3])
        self.seen, self._frame_id, self._at_s, self._answers = True, frame_id, None, answers
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._joints = rospy.Publisher("joint_states", JointState, queue_size=10)
        self._pose = rospy.Publisher("target/pose", PoseStamped, queue_size=10)
        rospy.Subscriber("servo_server/delta_twist_cmds", TwistStamped, self._on_twist, tcp_nodelay=True)
        self._lock = threading.Lock()
        threading.Thread(target=self._run_until_shutdown, daemon=True).start()

    def _run_until_shutdown(self):
        try:
            self._run()
        except rospy.ROSException:
            if not rospy.is_shutdown():
                raise

    def _run(self):
        tick = 100
        while not rospy.is_shutdown():
            tick += 1
            now = rospy.Time.from_sec(tick * PERIOD_S)
            image = tick % IMAGE_TICKS == 0
            self._clock.publish(now)
            time.sleep(BREATH_S)
            self._tick(now, image)
            until_s = time.monotonic() + BREATH_S * (100.0 if image else 0.0)
            while time.monotonic() < until_s and now.to_nsec() not in self._answers:
                time.sleep(0.001)

    def _on_twist(self, message):
        with self._lock:
            now_s, v, w = rospy.get_time(), message.twist.linear, message.twist.angular
            twist = np.array([v.x, v.y, v.z, w.x, w.y, w.z])
            self.twists.append((message.header.frame_id, twist))
            dt_s, self._at_s = min(now_s - (self._at_s or now_s), 0.05), now_s
            R = self.kinematics.pose(self.q)[:3, :3]  # the driver's own kinematics, from the base's axes
            twist = np.concatenate([R.T @ twist[:3], R.T @ twist[3:]])
            self.q = self.q + dt_s * np.linalg.pinv(self.kinematics.jacobian(self.q), rcond=1e-3) @ twist

    def move(self, twist):
        """Puts the arm elsewhere."""
        with self._lock:
            self.q = self.q + np.linalg.pinv(self.kinematics.jacobian(self.q), rcond=1e-3) @ twist

    def _tick(self, now, image):
        with self._lock:
            q = self.q
            names = self.kinematics.joint_names
            for part in (names[:1], names[1:]):
                message = JointState(name=list(part), position=[float(q[names.index(name)]) for name in part])
                message.header.stamp = now
                self._joints.publish(message)
            if not image:
                return
            X_CT = np.linalg.inv(self.kinematics.pose(q)) @ self.X_WT
            message = PoseStamped()
            message.header.stamp, message.header.frame_id = now, self._frame_id
            for axis, value in zip("xyz", X_CT[:3, 3]):
                setattr(message.pose.position, axis, float(value))
            xyzw = spatial.quaternion_xyzw(X_CT[:3, :3]) if self.seen else np.zeros(4)
            for axis, value in zip("xyzw", xyzw):
                setattr(message.pose.orientation, axis, float(value))
            self._pose.publish(message)


class TwistOut(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_twist_out")
        robot = rospy.get_param("scenario/robot")
        cls.base = robot["base_link"]
        kinematics = kinematics_of(rospy.get_param("robot_description"), robot)
        q = kinematics.vector({**dict.fromkeys(kinematics.joint_names, 0.0),
                               **rospy.get_param("scenario/experiment/goal/joints")})
        cls.watcher = Watcher()
        cls.plant = Plant(kinematics, q, robot["tip_link"], cls.watcher.states)
        wait_until(lambda: cls.watcher.goals.get_num_connections() and cls.watcher.states, "the controller", LIMIT_S)

    def left(self, X_goal):
        X = np.linalg.inv(X_goal) @ self.plant.kinematics.pose(self.plant.q)
        return float(np.linalg.norm(X[:3, 3])), float(spatial.rotation_angle(X[:3, :3]))

    def taught(self):
        answer = call("teach", Teach, 0.5)
        if not answer.success:
            rospy.logwarn_throttle(1.0, "teach: %s", answer.message)
        return answer.success

    def test_it_comes_home_and_rests_while_the_target_is_not_seen(self):
        X_goal = self.plant.kinematics.pose(self.plant.q)
        wait_until(self.taught, "a goal", LIMIT_S)
        self.plant.move(OFF)
        self.assertGreater(self.left(X_goal)[0], 0.05)
        goal = self.watcher.send_goal("taught", time_limit_s=100.0)
        wait_until(lambda: self.plant.twists and np.linalg.norm(self.plant.twists[-1][1]) > 0.01, "motion", LIMIT_S)
        self.plant.seen = False
        wait_until(lambda: not self.plant.twists[-1][1].any(), "rest", LIMIT_S)
        self.assertIn("unit quaternion", wait_until(
            lambda: next((state.status_text for state in list(self.watcher.states.values())
                          if "quaternion" in state.status_text), ""), "a state that says why", LIMIT_S))
        self.plant.seen = True
        result = self.watcher.wait_result(goal, LIMIT_S).result
        self.assertTrue(result.converged, result.reason)
        self.assertEqual({frame for frame, _ in self.plant.twists}, {self.base})
        left_m, left_rad = self.left(X_goal)
        self.assertLess(left_m, ARRIVED_M)
        self.assertLess(left_rad, ARRIVED_RAD)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "twist_out", TwistOut, sys.argv)
