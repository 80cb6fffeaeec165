#!/usr/bin/env python3
"""Goal view, error plot, frustum and buttons of the node rviz_view."""
import sys
import threading
import unittest

import numpy as np
import rospy
from sensor_msgs.msg import Image
from visualization_msgs.msg import InteractiveMarkerFeedback, InteractiveMarkerInit, Marker
from wiring import LIMIT_S, wait_until, Watcher


class RvizView(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_rviz_view")
        cls.watcher, cls.images, cls.lock = Watcher(), {}, threading.Lock()
        cls.plots = []
        cls.clicks = rospy.Publisher("buttons/feedback", InteractiveMarkerFeedback, queue_size=10)
        rospy.Subscriber("camera/image_raw", Image, cls.keep, buff_size=1 << 24)
        rospy.Subscriber("error_plot", Image, cls.plots.append)
        cls.watcher.wait_connected()
        wait_until(lambda: cls.clicks.get_num_connections(), "rviz_view to listen")

    @classmethod
    def keep(cls, image):
        cls.images[image.header.stamp.to_nsec()] = bytes(image.data)

    def press(self, name, condition, what):
        """Click, and once more when nothing has happened: rospy may lose what is sent right after it has connected."""
        for _ in range(3):
            self.click(name)
            try:
                return wait_until(condition, what, limit_s=15.0)
            except AssertionError as error:
                found = error
        raise found

    def click(self, name):
        self.clicks.publish(InteractiveMarkerFeedback(marker_name=name, client_id="/rviz",
                                                      event_type=InteractiveMarkerFeedback.BUTTON_CLICK))

    def phase(self):
        return self.watcher.state.phase if self.watcher.state else ""

    @staticmethod
    def coloured(plot):
        picture = np.frombuffer(plot.data, np.uint8).reshape(plot.height, plot.width, 3)
        return int((picture.max(axis=2).astype(int) - picture.min(axis=2) > 60).sum())

    def test_1_run_again_runs_the_experiment_also_when_time_stands_still(self):
        # The simulator has not begun yet.
        self.press("run again", lambda: self.phase() in ("to_goal", "servo"), "the experiment to begin")
        wait_until(lambda: self.phase() == "servo", "the experiment to servo")
        goal = rospy.wait_for_message("goal_view", Image, LIMIT_S)
        self.assertEqual(bytes(goal.data), self.images[goal.header.stamp.to_nsec()])
        taught = [stamp_ns for stamp_ns, state in self.watcher.states.items() if state.phase == "teach"]
        self.assertEqual(goal.header.stamp.to_nsec(), min(taught))

    def test_2_the_errors_are_drawn_while_they_fall(self):
        # Its result too, which may come later: the next test waits for that of another goal.
        wait_until(lambda: self.phase() == "done" and self.watcher.result, "the servo to end")
        coloured = self.coloured(self.plots[0])
        wait_until(lambda: self.coloured(self.plots[-1]) > coloured + 300, "the curves of the servo to be drawn")

    def test_3_the_taught_view_is_found_again_and_stop_stops(self):
        self.watcher.result = None
        result = self.press("servo to the taught view", lambda: self.watcher.result, "the servo to end").result
        self.assertTrue(result.converged, result.reason)
        self.watcher.result = None
        self.press("run again", lambda: self.phase() == "to_goal", "the next experiment")
        result = self.press("stop", lambda: self.watcher.result, "the stop").result
        self.assertEqual(result.reason, f"stopped by {rospy.resolve_name('rviz_view')}")

    def test_4_reset_sets_time_back(self):
        before_s = rospy.get_time()
        self.press("reset", lambda: rospy.get_time() < before_s, "time to go back")

    def test_5_frustum_and_buttons_are_there(self):
        frustum = rospy.wait_for_message("camera_frustum", Marker, LIMIT_S)
        self.assertEqual((frustum.type, len(frustum.points)), (Marker.LINE_LIST, 16))
        depth_m = rospy.get_param("scenario/experiment/z_star_m")
        self.assertEqual({point.z for point in frustum.points}, {0.0, depth_m})
        buttons = rospy.wait_for_message("buttons/update_full", InteractiveMarkerInit, LIMIT_S)
        self.assertEqual({button.name for button in buttons.markers},
                         {"run again", "servo to the taught view", "stop", "reset"})


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "rviz_view_test", RvizView, sys.argv)
