#!/usr/bin/env python3
"""A node as it would stand in a package written for Gazebo: it knows topics and nothing of who simulates.

Turns the head to `~pan` and `~tilt` and, once it is there, publishes the mean brightness of what it sees.
"""
import rospy
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import Float64

NEAR = 0.01  # [rad]


class LookAround:
    def __init__(self):
        self.goal = {"pan_joint": rospy.get_param("~pan"), "tilt_joint": rospy.get_param("~tilt")}
        self.commands = {name: rospy.Publisher("/pan_tilt/%s_position_controller/command" % name.split("_")[0], Float64,
                                               queue_size=1) for name in self.goal}
        self.there = False
        self.size = None
        self.brightness = rospy.Publisher("~brightness", Float64, queue_size=1, latch=True)
        rospy.Subscriber("/pan_tilt/joint_states", JointState, self.on_joints)
        rospy.Subscriber("/pan_tilt/head_camera/camera_info", CameraInfo, self.on_info)
        rospy.Subscriber("/pan_tilt/head_camera/image_raw", Image, self.on_image)
        rospy.Timer(rospy.Duration(0.05), self.on_timer)

    def on_timer(self, _):
        for name, publisher in self.commands.items():
            publisher.publish(self.goal[name])

    def on_joints(self, message):
        self.there = all(abs(message.position[message.name.index(name)] - goal) < NEAR
                         for name, goal in self.goal.items())

    def on_info(self, message):
        self.size = (message.width, message.height)

    def on_image(self, message):
        if self.there and self.size == (message.width, message.height) and message.encoding == "rgb8":
            self.brightness.publish(sum(message.data) / len(message.data))


if __name__ == "__main__":
    rospy.init_node("look_around")
    LookAround()
    rospy.spin()
