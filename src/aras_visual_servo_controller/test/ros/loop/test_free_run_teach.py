#!/usr/bin/env python3
"""In a free run, with a target that moves, servo and camera are taught the image they say, not a later one."""
import sys
import unittest

import rospy

from aras_visual_servo_msgs.srv import Teach
from wiring import Watcher, call, wait_until

Z_STAR_M, TIMES = 0.59, 10


class FreeRunTeach(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_free_run_teach")
        cls.watcher = Watcher()
        wait_until(lambda: cls.watcher.features and cls.watcher.states, "the first answers")
        stood_at = cls.latest().xg
        wait_until(lambda: cls.latest().valid and abs(cls.latest().xg - stood_at) > 0.01, "the target to move")

    @classmethod
    def latest(cls):
        features = dict(cls.watcher.features)
        return features[max(features)]

    def test_the_reference_of_both_is_the_image_of_the_stamp_that_was_taught(self):
        for _ in range(TIMES):
            answer = call("teach", Teach, Z_STAR_M)
            self.assertTrue(answer.success, answer.message)
            stamp_ns = answer.stamp.to_nsec()
            view = wait_until(lambda: self.watcher.features.get(stamp_ns), "the image that was taught")
            after = wait_until(lambda: [each for _, each in sorted(dict(self.watcher.features).items())
                                        if each.reference_stamp_ns == stamp_ns], "features relative to it")[0]
            self.assertEqual((after.area_star, after.z_star_m), (view.area, Z_STAR_M))
            taught = rospy.get_param("controller/taught_reference")
            self.assertEqual(taught["s_star"], [Z_STAR_M * view.xg, Z_STAR_M * view.yg, Z_STAR_M, view.alpha])
            self.assertEqual(taught["view"]["m"], list(view.m))
            others = [each.xg for stamp, each in dict(self.watcher.features).items() if stamp != stamp_ns]
            self.assertNotIn(view.xg, others)  # every image is another one


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "free_run_teach", FreeRunTeach, sys.argv)
