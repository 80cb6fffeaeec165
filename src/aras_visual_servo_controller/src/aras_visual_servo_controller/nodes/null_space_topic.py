"""Topic `null_space_bars`: an image for rviz that shows, for each joint, its part in the camera's motion and its motion
in the null space."""

import time
from typing import Any

import rospy
from sensor_msgs.msg import Image
from aras_visual_servo import Servo, ServoRecord
from .conversions import picture_message

PERIOD_S = 0.1  # wall time between two images


class _Loader(rospy.SubscribeListener):
    """Loads the drawing code on the first subscription, in rospy's connecting thread.

    It brings OpenCV along, which takes 0.2 s of CPU time: a run without viewers does without, and no answer to an
    image waits for it.

    Attributes: bars: the module `null_space_bars`, None before the first subscriber.
    """

    bars = None

    def peer_subscribe(self, *_):
        """Called when a subscriber connects."""
        from . import null_space_bars
        self.bars = null_space_bars


class NullSpaceTopic:
    """Draws and publishes the image only while it has subscribers.

    Args: kinematics: `Kinematics`.  servo: `Servo`, whose inverse splits the joint velocities.
    """

    def __init__(self, kinematics: Any, servo: Servo) -> None:
        self._kinematics, self._servo = kinematics, servo
        self._wall_s = -PERIOD_S
        self._loader = _Loader()
        self._publisher = rospy.Publisher("null_space_bars", Image, self._loader, queue_size=1)

    def use(self, servo: Servo) -> None:
        """Go on with another servo."""
        self._servo = servo

    def show(self, record: ServoRecord, frame_id: str) -> None:
        """Show a `ServoRecord`, at most once every PERIOD_S of wall time."""
        bars = self._loader.bars
        if bars is None or not self._publisher.get_num_connections() or time.monotonic() - self._wall_s < PERIOD_S:
            return
        self._wall_s = time.monotonic()
        shares = bars.shares(self._servo.split, record.q, record.q_dot, self._kinematics.velocity)
        picture = bars.draw(self._kinematics.joint_names, *shares)
        self._publisher.publish(picture_message(picture, record.stamp_ns, frame_id))
