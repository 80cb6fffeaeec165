"""The controller of a scenario as an rclpy node: the core's own objects, wired over ROS 2. Prints JSON at the end.

    controller.py SCENARIO
It arms the lockstep with an empty command, starts time, answers every image, and has the simulator pause at the end.
"""
import json
import sys
import threading
import time

import numpy as np
import rclpy
from builtin_interfaces.msg import Time
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty

import aras_visual_servo as avs
from aras_visual_servo_msgs.msg import MomentFeatures, SimStatus
from aras_visual_servo_msgs.srv import PauseAt, SetReference

NAMESPACE, LIMIT_S = "/aras_visual_servo/", 60.0


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def time_of(stamp_ns):
    return Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)


class Caller:
    """Services, called from within a callback: they have a node and a thread of their own."""

    def __init__(self):
        self.node = rclpy.create_node("own_caller")
        threading.Thread(target=rclpy.spin, args=(self.node, SingleThreadedExecutor()), daemon=True).start()

    def of(self, kind, name):
        client = self.node.create_client(kind, NAMESPACE + name)
        assert client.wait_for_service(LIMIT_S), name

        def call(**fields):
            answered, future = threading.Event(), client.call_async(kind.Request(**fields))
            future.add_done_callback(lambda _: answered.set())
            assert answered.wait(LIMIT_S), name
            return future.result()
        return call


class Controller:
    def __init__(self, name):
        scenario, caller = avs.load_scenario(name), Caller()
        self.node, self.arm = rclpy.create_node("own_controller"), scenario.kinematics()
        self.set_reference, self.pause_at, self.unpause = (caller.of(kind, name) for kind, name in (
            (SetReference, "camera/set_reference"), (PauseAt, "sim/pause_at"), (Empty, "sim/unpause")))
        self.servo = avs.Servo(self.arm, scenario.servo)
        self.sequence = avs.ExperimentSequence(self.arm, self.servo, scenario.experiment, self.teach)
        self.session = avs.Session(self.sequence, self.servo.config.input_timeout_s, self.servo.config.time_limit_s)
        self.session.begin("experiment", "", [], [], 0.0, 0, time.monotonic())
        self.answered, self.last, self.status, self.end_ns = 0, None, None, None
        self.commands = self.node.create_publisher(JointState, NAMESPACE + "joint_command", 10)
        pairer = avs.StampPairer()
        for kind, topic, add in ((MomentFeatures, "camera/features", pairer.add_features),
                                 (JointState, "image_joint_states", pairer.add_joints)):
            self.node.create_subscription(kind, NAMESPACE + topic, lambda message, add=add: [
                self.answer(*pair) for pair in add(nanoseconds(message.header.stamp), message)],
                qos_profile_sensor_data)
        self.node.create_subscription(SimStatus, NAMESPACE + "sim/status", self.on_status, 10)

    def teach(self, stamp_ns, z_star_m):
        answer = self.set_reference(z_star_m=float(z_star_m), stamp=time_of(stamp_ns))
        assert answer.success, answer.message

    def on_status(self, message):
        self.status = message

    def answer(self, stamp_ns, features, joints):
        seen = self.servo.source.read(features, None, self.servo.reference)
        q = None if joints is None else dict(zip(joints.name, joints.position))
        q = None if q is None else np.array([q[name] for name in self.arm.joint_names])
        command, self.last = self.session.answer(stamp_ns, seen, q, stamp_ns, time.monotonic())
        if self.session.active and self.sequence.done:
            self.session.active, self.end_ns = False, stamp_ns + round(avs.CLOSING_S * 1e9)
            self.pause_at(stamp=time_of(self.end_ns))
        self.send(command)
        self.answered += 1

    def send(self, command):
        position, velocity = command.position, command.velocity
        names = sorted({*position, *velocity})
        message = JointState(name=names, position=[position.get(name, np.nan) for name in names] if position else [],
                             velocity=[velocity.get(name, np.nan) for name in names] if velocity else [])
        message.header.stamp = time_of(command.stamp_ns)
        self.commands.publish(message)

    def until(self, reached):
        deadline = time.monotonic() + LIMIT_S
        while not reached():
            rclpy.spin_once(self.node, timeout_sec=0.05)
            assert time.monotonic() < deadline, (self.status, self.last)

    def run(self):
        while self.status is None or not self.status.lockstep_armed:
            self.send(avs.Command(0))
            rclpy.spin_once(self.node, timeout_sec=0.1)
        self.until(lambda: all(self.node.count_publishers(NAMESPACE + topic) for topic in
                               ("camera/features", "image_joint_states")))
        time.sleep(1.0)  # until the relay knows of the listeners too
        began_s = time.monotonic()
        self.unpause()
        self.until(lambda: self.end_ns and self.status.paused and nanoseconds(self.status.header.stamp) >= self.end_ns)
        return {"status": self.last.status.name, "hash": self.status.run_hash, "frames": self.status.frames,
                "answered": self.answered, "dropped": self.status.dropped_frames,
                "wall_s": time.monotonic() - began_s}


if __name__ == "__main__":
    rclpy.init()
    print(json.dumps(Controller(sys.argv[1]).run()), flush=True)
