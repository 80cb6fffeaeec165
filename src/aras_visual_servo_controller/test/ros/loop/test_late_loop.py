#!/usr/bin/env python3
"""The experiment with images that come 80 ms late: it converges, and it is the in-process run, bit by bit."""
import sys

from test_closed_loop import ClosedLoop


class LateLoop(ClosedLoop):
    OVERRIDES = {"sim.cameras": [{"name": "camera", "frame": "camera_optical_frame", "width": 320, "height": 240,
                                  "horizontal_fov_rad": 1.41, "rate_hz": 30.0, "latency_s": 0.08}]}


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "late_loop", LateLoop, sys.argv)
