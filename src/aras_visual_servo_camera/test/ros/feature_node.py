"""What the tests of camera_node for one kind of features share: images are published until features of them come."""

import unittest

import rospy
from aras_visual_servo_msgs.srv import SetReference
from sensor_msgs.msg import CameraInfo, Image

from test_camera_node import LIMIT_S, wait_until


class FeatureNodeTest(unittest.TestCase):
    """Test cases over one node. Attributes: TOPIC, MESSAGE: of the features.  FOCAL_PX: of the camera."""

    TOPIC, MESSAGE, FOCAL_PX = "", None, 100.0

    @classmethod
    def setUpClass(cls):
        if cls is FeatureNodeTest:
            raise unittest.SkipTest("its tests are those of the classes below it")
        cls.clock, cls.received = 100, []
        cls.images = rospy.Publisher("camera/image_raw", Image, queue_size=200)
        cls.infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=200)
        cls.subscriber = rospy.Subscriber(cls.TOPIC, cls.MESSAGE, cls.received.append, queue_size=200)
        rospy.wait_for_service("camera/set_reference", LIMIT_S)
        cls.set_reference = staticmethod(rospy.ServiceProxy("camera/set_reference", SetReference))
        assert wait_until(lambda: cls.images.get_num_connections() and cls.infos.get_num_connections()
                          and cls.subscriber.get_num_connections())

    @classmethod
    def info_of(cls, width, height):
        """CameraInfo of a camera without distortion that looks through the middle of its image."""
        return CameraInfo(height=height, width=width, distortion_model="plumb_bob", D=[0.0] * 5,
                          K=[cls.FOCAL_PX, 0, (width - 1) / 2, 0, cls.FOCAL_PX, (height - 1) / 2, 0, 0, 1])

    def answer_to(self, pixels):
        """Features of this image, (h, w) uint8, by its stamp."""
        type(self).clock += 1
        height, width = pixels.shape
        image = Image(height=height, width=width, encoding="mono8", step=width, data=pixels.tobytes())
        info = self.info_of(width, height)
        image.header.stamp = info.header.stamp = rospy.Time(self.clock)
        image.header.frame_id = info.header.frame_id = "camera_optical_frame"
        found = []

        def answered():
            self.images.publish(image)  # again, until the connections stand: the node takes equal stamps
            self.infos.publish(info)
            found.extend(message for message in self.received if message.header.stamp == image.header.stamp)
            return found

        self.assertTrue(wait_until(answered))
        return found[0]
