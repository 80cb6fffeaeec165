#!/usr/bin/env python3
"""Answers every image with a velocity of the pan joint, `~delay_s` of wall time late."""
import time

import rospy
from listening import command, command_publisher, until_sent_to
from sensor_msgs.msg import Image

if __name__ == "__main__":
    rospy.init_node("answering_node")
    publisher = command_publisher()

    def answer(image):
        time.sleep(rospy.get_param("~delay_s"))
        publisher.publish(command(image.header.stamp, pan=rospy.get_param("~velocity")))

    images = rospy.Subscriber("camera/image_raw", Image, answer, queue_size=1000, tcp_nodelay=True)
    until_sent_to(images)
    publisher.publish(command(rospy.Time(0)))  # arms the lockstep
    rospy.set_param("~ready", True)
    rospy.spin()
