"""A ROS node of one's own that servoes.   python3 examples/07_ros_node.py __ns:=aras_visual_servo
First `roslaunch aras_visual_servo_controller servo.launch experiment:=false lockstep:=false real_time_factor:=1`."""
import queue

import rospy
from sensor_msgs.msg import JointState
import aras_visual_servo as avs
from aras_visual_servo_msgs.msg import MomentFeatures
from aras_visual_servo_msgs.srv import GetModelState, SetJointPositions, SetReference

rospy.init_node("own_servo")
scenario = avs.load_scenario("experiment_1")
arm, z_star_m = scenario.kinematics(), scenario.experiment["z_star_m"]
servo, pairer, pairs = avs.Servo(arm, scenario.servo), avs.StampPairer(), queue.Queue()
place = rospy.ServiceProxy("sim/set_joint_positions", SetJointPositions)
state = rospy.ServiceProxy("sim/get_model_state", GetModelState)
commands = rospy.Publisher("joint_command", JointState, queue_size=1)
for topic, kind, add in (("camera/features", MomentFeatures, pairer.add_features),
                         ("joint_states", JointState, pairer.add_joints)):
    rospy.Subscriber(topic, kind, lambda m, add=add: [pairs.put(pair) for pair in add(m.header.stamp.to_nsec(), m)])
place.wait_for_service()
place(list(arm.joint_names), list(scenario.goal_posture(arm)))
at_goal_ns = placed_ns = state("target", "").header.stamp.to_nsec() + 10**9  # the arm settles for 1 s
next(pair for pair in iter(pairs.get, None) if pair[0] > at_goal_ns)
rospy.ServiceProxy("camera/set_reference", SetReference)(z_star_m=z_star_m, from_current_view=True)
while not rospy.is_shutdown() and not servo.finished:
    stamp_ns, features, joints = pairs.get()
    if joints is None or stamp_ns <= placed_ns or features.reference_stamp_ns <= at_goal_ns:
        continue
    q = dict(zip(joints.name, joints.position))
    if servo.reference is None:
        servo.teach(features, q, features.z_star_m)
        place(list(arm.joint_names), list(scenario.start_posture(arm)))
        placed_ns = state("target", "").header.stamp.to_nsec()  # only later images show the start
        servo.start(placed_ns)
    else:
        command, record = servo.step(avs.Observation(stamp_ns, features, q), 1.0 / 30.0)
        commands.publish(name=list(command.velocity), velocity=list(command.velocity.values()))
print(record.status.name, record.status_text)
