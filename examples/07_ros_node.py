"""A ROS node of one's own that servoes: image features and joint states in, joint velocities out.

    roslaunch aras_visual_servo_controller servo.launch experiment:=false lockstep:=false &
    rosservice call /aras_visual_servo/teach "{}"       # the goal is the view of now; then move the arm away and
    python3 examples/07_ros_node.py __ns:=aras_visual_servo
"""
import rospy
from sensor_msgs.msg import JointState

import aras_visual_servo as avs
from aras_visual_servo_msgs.msg import MomentFeatures

rospy.init_node("own_servo")
scenario = avs.load_scenario(rospy.get_param("~scenario", "experiment_1"))
