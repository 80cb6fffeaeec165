#!/usr/bin/env python3
"""A reset with a monotonic clock against the fresh start of the same process, and limits from the parameter server."""
import io
import math
import unittest

import genpy
import rospy
import rostest
from aras_visual_servo_msgs.msg import JointControllerState, SimStatus
from aras_visual_servo_msgs.srv import SetModelState, SpawnModel, Step
from aras_visual_servo_sim import Simulation
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, TwistStamped
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import Float64
from std_srvs.srv import Empty

from listening import Listener, command_publisher, service, until, until_sent_to

STEPS = 700                  # of 1 ms
PAN = 0.9                    # set-point [rad]
MAX_VELOCITY = 0.4           # of joint_limits/pan [rad/s]
OVERSHOOT = 1.05             # an effort joint is pushed no further above the limit, and slows down by its friction
TOPICS = {"joint_states": JointState, "camera/image_raw": Image, "camera/camera_info": CameraInfo,
          "ground_truth/camera_pose": PoseStamped, "ground_truth/camera_twist": TwistStamped,
          "ground_truth/target_pose": PoseStamped, "ground_truth/target_twist": TwistStamped,
          "pan_controller/state": JointControllerState}


def shifted(message, start):
    """Bytes of a message with its stamp counted from `start`, and without the sender's running number."""
    message.header.seq = 0
    message.header.stamp = genpy.Time() + (message.header.stamp - start)
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class FreshStart(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.status = Listener("sim/status", SimStatus)
        cls.listeners = {name: Listener(name, kind) for name, kind in TOPICS.items()}
        until_sent_to(*(listener.subscriber for listener in cls.listeners.values()))
        cls.pan = command_publisher("pan_controller/command", Float64)
        cls.fresh = cls.run_once()
        # Everything a reset has to undo: a model that came, one that was put elsewhere, set-points, time.
        sphere = Pose(Point(0.0, 0.0, 0.1), Quaternion(w=1.0))
        assert service("sim/spawn_model", SpawnModel)(model_name="ball", model_xml="sphere_m: 0.05",
                                                      initial_pose=sphere).success
        assert service("sim/set_model_pose", SetModelState)(model_name="target", pose=sphere).success
        service("sim/step", Step)(steps=123)
        service("sim/reset", Empty)()
        cls.again = cls.run_once()

    @classmethod
    def run_once(cls):
        """dict of topic -> messages of STEPS steps, their bytes; the status after it; the clock at the start."""
        start = cls.status.newer(lambda m: m.paused and m.ticks == 0, "a start").header.stamp
        for listener in cls.listeners.values():
            listener.messages[:] = []
        cls.pan.publish(PAN)
        cls.pan.publish(math.nan)  # is refused and counted, after the command before it was taken
        cls.status.newer(lambda m: m.refused_commands == 1, "the command")
        states = cls.listeners["pan_controller/state"]
        service("sim/step", Step)(steps=1)
        until(lambda: states.messages and states.messages[-1].set_point == PAN, "the set-point")
        service("sim/step", Step)(steps=STEPS - 1)
        status = cls.status.newer(lambda m: m.ticks == STEPS, "the end")
        end = start + genpy.Duration(0, STEPS * 1_000_000)
        for name, listener in cls.listeners.items():
            if name in ("joint_states", "pan_controller/state"):
                until(lambda listener=listener: listener.messages[-1].header.stamp == end, "the last of " + name)
            else:
                until(lambda listener=listener: len(listener.messages) == status.frames, "every frame's " + name)
        return {name: [shifted(message, start) for message in listener.messages]
                for name, listener in cls.listeners.items()}, status, start

    def test_a_reset_run_has_the_bytes_of_the_fresh_one_apart_from_the_clock(self):
        for name in TOPICS:
            fresh, again = self.fresh[0][name], self.again[0][name]
            self.assertGreater(len(fresh), 10, name)
            self.assertEqual(len(fresh), len(again), name)
            for k, (one, other) in enumerate(zip(fresh, again)):
                self.assertTrue(one == other, "%s, message %d" % (name, k))
        self.assertEqual(self.fresh[1].run_hash, self.again[1].run_hash)
        self.assertEqual(self.fresh[1].dropped_frames, self.again[1].dropped_frames)
        self.assertGreater(self.again[2], self.fresh[1].header.stamp, "the clock goes on")

    def test_joint_limits_of_the_namespace_override_those_of_the_urdf(self):
        controllers = {name: rospy.get_param(name) for name in ("lift_controller", "pan_controller", "joint_limits")}
        urdf, sim = rospy.get_param("robot_description"), rospy.get_param("sim/sim")
        velocities = {}
        for limits in (True, False):
            simulation = Simulation(urdf, sim, controllers if limits else
                                    {name: value for name, value in controllers.items() if name != "joint_limits"})
            simulation.set_command(position={"pan": PAN})
            fastest = 0.0
            for _ in range(STEPS):
                simulation.step(1)
                fastest = max(fastest, abs(simulation.joint_velocities[simulation.joint_names.index("pan")]))
            velocities[limits] = fastest
        self.assertLess(velocities[True], OVERSHOOT * MAX_VELOCITY)
        self.assertGreater(velocities[False], 1.5 * MAX_VELOCITY)
        states = [JointState().deserialize(data) for data in self.fresh[0]["joint_states"]]
        fastest = max(abs(state.velocity[state.name.index("pan")]) for state in states)
        self.assertLess(fastest, OVERSHOOT * MAX_VELOCITY)
        self.assertGreater(fastest, 0.5 * MAX_VELOCITY, "it moves")


if __name__ == "__main__":
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", "fresh_start", FreshStart)
