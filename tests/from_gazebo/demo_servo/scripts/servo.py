#!/usr/bin/env python3
"""Servos a free camera to the goal image by its grey levels; prints how far it is off and a hash as YAML."""
import hashlib
import queue
import time

import numpy
import rospy
import yaml
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import GetModelState, SetModelState
from scipy.ndimage import gaussian_filter
from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import Empty

NAME = "flying_camera"
GOAL = ((1.1, 0.0, 1.0), (0.0, 0.0, 1.0, 0.0))                # it looks along -x
START = ((1.15, 0.03, 1.02), (0.0261769, 0.0, 0.9996573, 0.0))  # turned by 3 degrees about its axis
R_LC = numpy.array(((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)))  # the sensor looks along x of its link
DEPTH_M, GAIN_PER_S, IMAGES = 1.09, 4.0, 90
SMOOTH_PX, MARGIN = 4.0, 10


def state(pose, twist=(0.0,) * 6):
    made = ModelState(model_name=NAME, reference_frame="world")
    for part, values, axes in ((made.pose.position, pose[0], "xyz"), (made.pose.orientation, pose[1], "xyzw"),
                               (made.twist.linear, twist[:3], "xyz"), (made.twist.angular, twist[3:], "xyz")):
        for axis, value in zip(axes, values):
            setattr(part, axis, float(value))
    return made


def rotation(q):
    x, y, z, w = q
    return numpy.array(((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))))


class Servo:
    def __init__(self):
        self._images, self._info = queue.Queue(), queue.Queue()
        self._hash = hashlib.sha256()
        self._get = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState)
        self._set = rospy.ServiceProxy("/gazebo/set_model_state", SetModelState)
        self._get.wait_for_service()
        subscriber = rospy.Subscriber("/camera/color/image_raw", Image, self._images.put)
        info = rospy.Subscriber("/camera/color/camera_info", CameraInfo, self._info.put)
        while not (subscriber.get_num_connections() and info.get_num_connections()):
            time.sleep(0.05)  # wall time: simulated time stands still
        self._set(state(GOAL))
        rospy.ServiceProxy("/gazebo/unpause_physics", Empty)()

    def look(self):
        """The next image, grey."""
        message = self._images.get(timeout=60.0)
        self._hash.update(message.data)
        image = numpy.frombuffer(message.data, numpy.uint8).reshape(message.height, message.width, 3)
        return gaussian_filter(image.mean(axis=2), SMOOTH_PX)[MARGIN:-MARGIN, MARGIN:-MARGIN]

    def run(self):
        goal = self.look()
        K = numpy.reshape(self._info.get(timeout=60.0).K, (3, 3))
        L = interaction(goal, K)
        self._set(state(START))
        for _ in range(IMAGES):
            self._step((self.look() - goal).ravel(), L)
        self.look()  # after which the world waits, so that it is told where the camera is at that time
        return self._told()

    def _step(self, error, L):
        here = self._get(NAME, "world").pose
        pose = ((here.position.x, here.position.y, here.position.z),
                (here.orientation.x, here.orientation.y, here.orientation.z, here.orientation.w))
        self._hash.update(numpy.array(pose[0] + pose[1]).tobytes())
        twist = -GAIN_PER_S * numpy.linalg.solve(L.T @ L, L.T @ error)
        R_WC = rotation(pose[1]) @ R_LC
        self._set(state(pose, (*(R_WC @ twist[:3]), *(R_WC @ twist[3:]))))

    def _told(self):
        pose = self._get(NAME, "world").pose
        off = numpy.array((pose.position.x, pose.position.y, pose.position.z)) - GOAL[0]
        return {"off_mm": float(1000.0 * numpy.linalg.norm(off)), "hash": self._hash.hexdigest()}


def interaction(image, K):
    """(n, 6): how the grey level of each pixel changes as the camera moves in front of a plane across its axis."""
    along_y, along_x = numpy.gradient(image)
    rows, columns = numpy.indices(image.shape) + MARGIN
    x, y = ((columns - K[0, 2]) / K[0, 0]).ravel(), ((rows - K[1, 2]) / K[1, 1]).ravel()
    I_x, I_y = K[0, 0] * along_x.ravel(), K[1, 1] * along_y.ravel()
    return -numpy.stack((-I_x / DEPTH_M, -I_y / DEPTH_M, (x * I_x + y * I_y) / DEPTH_M,
                         x * y * I_x + (1 + y * y) * I_y, -(1 + x * x) * I_x - x * y * I_y, y * I_x - x * I_y), axis=1)


if __name__ == "__main__":
    rospy.init_node("servo")
    print(yaml.safe_dump(Servo().run()))
