#!/usr/bin/env python3
"""Node of tests: the simulator plays a real arm. It stands between a simulator and the controller, jitters stamps,
thins out joint states, delays and loses images under the names of a USB camera's driver, and plays the arm's driver,
which takes position, velocity or trajectory set-points and passes one on every few milliseconds. Seeded.

Parameters: ~joint_rate_hz, ~seed, ~command (trajectory, position, velocity), ~lost, ~image_late_s [least, most],
~axis (a joint whose driver sends joint states of its own).
Topic ~fault (std_msgs/String): "joints", "axis" or "images" stop coming, "" mends it.
"""
import functools
import heapq
import sys
import threading

import numpy as np
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import Float64MultiArray, Header, String
from trajectory_msgs.msg import JointTrajectory

PERIOD_S = 0.008
IMAGE_JITTER_S, JOINT_JITTER_S, JOINT_LATE_S = 0.002, 0.001, 0.002
KINDS = {"trajectory": JointTrajectory, "position": Float64MultiArray, "velocity": Float64MultiArray}


class RoughPlant:
    def __init__(self):
        self._lock = threading.Lock()
        self._random = np.random.default_rng(rospy.get_param("~seed", 1))
        self._joint_period_s = 1.0 / rospy.get_param("~joint_rate_hz", 500.0)
        self._lost, self._late_s = rospy.get_param("~lost", 0.1), rospy.get_param("~image_late_s", [0.02, 0.15])
        self._command, self._axis = rospy.get_param("~command", "trajectory"), rospy.get_param("~axis", "")
        self._mail, self._number, self._last_s = [], 0, {}
        self._joints_s = self._tick_s = self._now_s = 0.0
        self._names, self._at, self._goal, self._infos, self._fault = [], {}, None, {}, ""
        self._joints = rospy.Publisher("/joint_states", JointState, queue_size=100)
        self._image = rospy.Publisher("/usb_cam/image_raw", Image, queue_size=10)
        self._info = rospy.Publisher("/usb_cam/camera_info", CameraInfo, queue_size=10)
        self._drive = rospy.Publisher("/plant/joint_command", JointState, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber("~fault", String, self._on_fault)
        rospy.Subscriber("/plant/joint_states", JointState, self._on_joints, tcp_nodelay=True)
        rospy.Subscriber("/plant/camera/camera_info", CameraInfo, self._on_info)
        rospy.Subscriber("/plant/camera/image_raw", Image, self._on_image, tcp_nodelay=True)
        rospy.Subscriber("/arm_controller/command", KINDS[self._command], self._on_command, tcp_nodelay=True)
        rospy.Subscriber("/clock", Clock, self._on_clock, tcp_nodelay=True)

    def _on_fault(self, message):
        self._fault = message.data

    def _post(self, kind, late_s, what):
        """Do it later; what is of one kind keeps its order."""
        at_s = max(rospy.get_time() + late_s, self._last_s.get(kind, 0.0))
        self._last_s[kind] = at_s
        self._number += 1
        heapq.heappush(self._mail, (at_s, self._number, what))

    def _jittered(self, stamp, stddev_s):
        return rospy.Time.from_sec(max(0.0, stamp.to_sec() + self._random.normal(0.0, stddev_s)))

    def _on_joints(self, message):
        with self._lock:
            self._names = message.name
            self._at = self._at or dict(zip(message.name, message.position))
            now_s = message.header.stamp.to_sec()
            if now_s - self._joints_s < self._joint_period_s - 1e-6 or self._fault == "joints":
                return
            self._joints_s = now_s
            axis = [k for k, name in enumerate(message.name) if name == self._axis]
            arm = [k for k in range(len(message.name)) if k not in axis]
            for kind, part in (("joints", arm), ("axis", axis)):
                if part and self._fault != kind:
                    stamp = self._jittered(message.header.stamp, JOINT_JITTER_S)
                    name, position = ([values[k] for k in part] for values in (message.name, message.position))
                    told = JointState(header=Header(stamp=stamp), name=name, position=position)
                    self._post(kind, JOINT_LATE_S, functools.partial(self._joints.publish, told))

    def _on_info(self, message):
        with self._lock:
            self._infos = {message.header.stamp: message}

    def _on_image(self, message):
        with self._lock:
            info = self._infos.get(message.header.stamp)
            if info is None or self._fault == "images" or self._random.random() < self._lost:
                return
            stamp = message.header.stamp = info.header.stamp = self._jittered(message.header.stamp, IMAGE_JITTER_S)
            assert stamp == info.header.stamp

            def send():
                self._info.publish(info)
                self._image.publish(message)
            self._post("image", self._random.uniform(*self._late_s), send)

    def _on_command(self, message):
        with self._lock:
            if self._command == "trajectory":
                (point,) = message.points
                self._goal = dict(zip(message.joint_names, point.positions)), point.time_from_start.to_sec()
            else:
                self._goal = dict(zip(sorted(self._names), message.data)), PERIOD_S

    def _on_clock(self, message):
        with self._lock:
            now_s = message.clock.to_sec()
            if now_s < self._now_s:  # the simulator was reset: the arm stands at its start again
                self._mail, self._last_s, self._at, self._goal = [], {}, {}, None
                self._joints_s = self._tick_s = 0.0
            self._now_s = now_s
            while self._mail and self._mail[0][0] <= now_s:
                heapq.heappop(self._mail)[2]()
            if now_s - self._tick_s >= PERIOD_S - 1e-6:
                passed_s, self._tick_s = min(now_s - self._tick_s, 5 * PERIOD_S), now_s
                self._pass_on(message.clock, passed_s)

    def _pass_on(self, stamp, passed_s):
        """One command of the driver: what it was told, and of a trajectory the part of the way of this period."""
        if self._goal is None or not self._at:
            return
        values, left_s = self._goal
        if self._command == "velocity":
            self._at.update({name: self._at[name] + passed_s * value for name, value in values.items()})
        else:
            part = min(1.0, passed_s / left_s)
            self._at.update({name: self._at[name] + part * (value - self._at[name]) for name, value in values.items()})
            self._goal = values, max(PERIOD_S, left_s - passed_s)
        command = JointState(name=list(values), position=[self._at[name] for name in values])
        command.header.stamp = stamp
        self._drive.publish(command)


if __name__ == "__main__":
    rospy.init_node("rough_plant")
    RoughPlant()
    rospy.spin()
    sys.exit(0)
