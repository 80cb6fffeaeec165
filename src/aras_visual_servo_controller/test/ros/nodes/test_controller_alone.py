#!/usr/bin/env python3
"""The controller against a plant played here: missing, late and broken input, goals, services."""
import math
import sys
import unittest

import rospy
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from aras_visual_servo_controller.nodes.null_space_bars import CAMERA
from aras_visual_servo_msgs.msg import ServoState
from aras_visual_servo_msgs.srv import SetReference, Teach
from wiring import FakePlant, Watcher, call, wait_until

JOINTS = ["J1", "J2", "J3", "J5", "J6", "gantry"]
NAN = math.nan


class ControllerAlone(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_controller_alone")
        cls.plant = FakePlant(JOINTS, SetReference)
        cls.watcher = Watcher()
        wait_until(cls.plant.connected, "the controller's subscriptions")
        wait_until(lambda: cls.watcher.goals.get_num_connections(), "the action server")
        wait_until(cls.watcher.connected, "the controller's topics")
        wait_until(cls.answered, "the first answer")

    @classmethod
    def answered(cls):
        """Send one more image; whether any was answered, so that every connection is known to carry messages.

        A publisher counts a connection a moment before the other side is ready, and what it sends then is lost.
        """
        cls.plant.publish()
        return bool(cls.watcher.states)

    def tearDown(self):
        self.plant.answer_after_s, self.plant.refusal = 0.0, ""
        self.plant.start()
        call("stop", Trigger)
        self.plant.stop()

    def wait_status(self, status):
        wait_until(lambda: self.watcher.state is not None and self.watcher.state.status == status, f"status {status}")
        return self.watcher.state

    def begin_servo(self):
        """Teach the view the plant shows with x = 0, then servo on one that is 0.05 m off."""
        stamp_ns = self.plant.publish(xn=0.0)
        wait_until(lambda: self.watcher.states.get(stamp_ns), "the answer")
        self.assertTrue(call("teach", Teach, 0.5).success)
        self.plant.start(xn=0.05)
        goal = self.watcher.send_goal("taught", time_limit_s=1000.0)
        self.plant.start(xn=0.1)
        wait_until(lambda: self.watcher.state.phase == "servo" and max(map(abs, self.last_velocity())) > 0.0,
                   "the arm to be commanded")
        return goal

    def last_velocity(self):
        commands = dict(self.watcher.commands)
        message = commands[max(commands)] if commands else None
        return list(message.velocity) if message is not None and message.velocity else [0.0]

    def assert_stands_still(self, state):
        """The command that goes with this state moves no joint. It has a connection of its own, and may come later."""
        stamp_ns = state.header.stamp.to_nsec()
        command = wait_until(lambda: self.watcher.commands.get(stamp_ns), "the command of this state")
        self.assertEqual(max(map(abs, command.velocity), default=0.0), 0.0, state.status_text)

    def test_answers_every_image_while_idle_with_an_empty_command(self):
        for _ in range(5):
            stamp_ns = self.plant.publish()
            command = wait_until(lambda: self.watcher.commands.get(stamp_ns), "the answer")
            self.assertEqual((len(command.name), len(command.velocity)), (0, 0))
            state = wait_until(lambda: self.watcher.states.get(stamp_ns), "servo_state")
            self.assertIn(state.phase, ("idle", "done"))

    def test_pairs_by_stamp_and_refuses_an_image_without_its_joint_state(self):
        stamp_ns = self.plant.publish(joints=False)
        self.plant.publish()  # a later joint state: that of the first image will never come
        state = wait_until(lambda: self.watcher.states.get(stamp_ns), "the refusal")
        self.assertIn("no joint state", state.status_text)

    def test_refuses_features_with_an_old_stamp(self):
        stamp_ns = self.plant.publish(stamp=rospy.Time.now() - rospy.Duration(5.0))
        state = wait_until(lambda: self.watcher.states.get(stamp_ns), "the refusal")
        self.assertIn("refused", state.status_text)

    def test_stops_when_features_stop_and_goes_on_when_they_come_back(self):
        self.begin_servo()
        self.plant.stop()
        state = self.wait_status(ServoState.STALE_INPUT)
        self.assertIn("no features", state.status_text)
        self.assert_stands_still(state)
        self.plant.start(xn=0.1)
        self.wait_status(ServoState.SERVOING)

    def test_a_goal_without_any_features_ends_by_its_time_limit(self):
        self.begin_servo()
        self.plant.stop()
        goal = self.watcher.send_goal("taught", time_limit_s=1.5)
        result = self.watcher.wait_result(goal).result
        self.assertEqual((result.status, result.converged), (ServoState.TIMED_OUT, False))

    def test_nan_features_leave_the_arm_still(self):
        self.begin_servo()
        self.plant.start(xn=NAN)
        state = wait_until(lambda: self.watcher.state if self.watcher.state.status in
                           (ServoState.FAULT, ServoState.TARGET_LOST) else None, "a status that tells of NaN")
        self.assert_stands_still(state)

    def test_nan_joint_positions_leave_the_arm_still(self):
        self.begin_servo()
        self.plant.start(xn=0.1, q=[NAN] + [0.1] * 5)
        self.assert_stands_still(self.wait_status(ServoState.FAULT))

    def test_a_target_that_is_lost_stops_the_arm(self):
        self.begin_servo()
        self.plant.start(target_visible=False, valid=False, xn=NAN, yn=NAN, an=NAN, alpha=NAN)
        self.assert_stands_still(self.wait_status(ServoState.TARGET_LOST))

    def test_service_stop_ends_the_goal_and_stops_the_arm(self):
        goal = self.begin_servo()
        self.assertTrue(call("stop", Trigger).success)
        result = self.watcher.wait_result(goal)
        self.assertEqual(result.result.status, ServoState.STOPPED)
        wait_until(lambda: max(map(abs, self.last_velocity())) == 0.0, "zero velocity")

    def test_a_cancelled_goal_is_preempted_and_stops_the_arm(self):
        goal = self.begin_servo()
        self.watcher.cancels.publish(id=goal)
        result = self.watcher.wait_result(goal)
        self.assertEqual((result.status.status, result.result.status), (2, ServoState.STOPPED))  # 2: PREEMPTED
        wait_until(lambda: max(map(abs, self.last_velocity())) == 0.0, "zero velocity")

    def test_sends_feedback_while_servoing(self):
        self.begin_servo()
        self.watcher.feedback = None
        state = wait_until(lambda: self.watcher.feedback, "feedback").feedback.state
        self.assertEqual(list(state.feature_names), ["xn", "yn", "an", "alpha"])

    def test_shows_null_space_bars_while_somebody_looks(self):
        self.begin_servo()
        pictures = []
        subscriber = rospy.Subscriber("null_space_bars", Image, pictures.append)
        bar = bytes(CAMERA) * 3  # of a bar that is longer than a stroke of a letter
        # A machine that stalls makes the arm rest for some images, of which the pictures have no bars.
        picture = wait_until(lambda: next((each for each in pictures if bar in each.data[each.step * 80:]), None),
                             "a picture with bars")
        subscriber.unregister()
        self.assertEqual((picture.encoding, picture.step), ("rgb8", 3 * picture.width))
        self.assertEqual(len(picture.data), picture.step * picture.height)
        self.assertIn(picture.header.stamp.to_nsec(), self.watcher.states)

    def test_a_goal_with_faults_is_refused_with_all_of_them(self):
        goal = self.watcher.send_goal("elsewhere", law="no_such_law", gains_per_s=[-1.0, 1.0, 1.0, 1.0])
        result = self.watcher.wait_result(goal)
        self.assertEqual(result.result.status, ServoState.FAULT)
        for word in ("elsewhere", "no_such_law"):
            self.assertIn(word, result.result.reason)

    def test_teaches_the_image_it_answered_by_its_stamp_while_images_go_on_coming(self):
        self.plant.answer_after_s = 0.2  # six images
        self.plant.start(xn=lambda count: 0.001 * count)
        for _ in range(3):
            stamp_ns = self.plant.publish(xn=0.0)
            wait_until(lambda: self.watcher.states.get(stamp_ns), "the answer")
            answer = call("teach", Teach, 0.4)
            self.assertTrue(answer.success, answer.message)
            came_since = sum(stamp > answer.stamp.to_nsec() for stamp in list(self.plant.published))
            self.assertGreaterEqual(came_since, 3)
            request = self.plant.asked[-1]
            self.assertEqual((request.stamp, request.z_star_m, request.from_current_view), (answer.stamp, 0.4, False))
            view = self.plant.published[answer.stamp.to_nsec()]
            self.assertEqual(rospy.get_param("controller/taught_reference")["s_star"],
                             [0.4 * view.xg, 0.4 * view.yg, 0.4, view.alpha])

    def test_a_view_that_the_camera_refuses_is_not_taught(self):
        self.plant.start(xn=0.0)
        wait_until(lambda: call("teach", Teach, 0.5).success, "the view to be taught")
        before = rospy.get_param("controller/taught_reference")
        self.plant.refusal = "reference/stamp: found another"
        self.plant.start(xn=0.2)
        answer = call("teach", Teach, 0.5)
        self.assertFalse(answer.success)
        self.assertIn("camera/set_reference: reference/stamp: found another", answer.message)
        self.assertEqual(rospy.get_param("controller/taught_reference"), before)

    def test_teach_is_refused_while_a_goal_is_active(self):
        self.begin_servo()
        self.assertIn("active", call("teach", Teach, 0.5).message)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "controller_alone", ControllerAlone, sys.argv)
