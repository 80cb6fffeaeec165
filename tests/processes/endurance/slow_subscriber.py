"""A node that looks at images, and takes its time over each: SECONDS TOPIC ..."""
import sys
import time

import rospy
from sensor_msgs.msg import Image

if __name__ == "__main__":
    rospy.init_node("slow_subscriber")
    for topic in sys.argv[2:]:
        rospy.Subscriber(topic, Image, lambda _: time.sleep(float(sys.argv[1])))
    rospy.spin()
