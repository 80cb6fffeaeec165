"""Sends goals as an rclpy action client, listens to what the relay offers, and prints what came as JSON."""
import json
import time

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

from aras_visual_servo_msgs.action import VisualServo
from aras_visual_servo_msgs.msg import MomentFeatures, ServoState

NAMESPACE, LIMIT_S = "/aras_visual_servo/", 60.0
TOPICS = {"/clock": Clock, "/tf": TFMessage, **{NAMESPACE + name: kind for name, kind in (
    ("camera/image_raw", Image), ("camera/camera_info", CameraInfo), ("camera/features", MomentFeatures),
    ("joint_states", JointState), ("ground_truth/camera_pose", PoseStamped), ("servo_state", ServoState))}}

rclpy.init()
node = rclpy.create_node("goals")
came, feedback = {topic: [] for topic in TOPICS}, []
for topic, kind in TOPICS.items():
    node.create_subscription(kind, topic, came[topic].append, qos_profile_sensor_data)
came["/tf_static"] = []
node.create_subscription(TFMessage, "/tf_static", came["/tf_static"].append, QoSProfile(
    depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))
client = ActionClient(node, VisualServo, NAMESPACE + "servo")
assert client.wait_for_server(LIMIT_S)
unpause = node.create_client(Empty, NAMESPACE + "sim/unpause")
assert unpause.wait_for_service(LIMIT_S)


def done(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=LIMIT_S)
    return future.result()


# Time stands still: this goal ends because it is cancelled.
first = done(client.send_goal_async(VisualServo.Goal(reference="experiment")))
time.sleep(1.0)
done(first.cancel_goal_async())
cancelled = done(first.get_result_async())
second = done(client.send_goal_async(VisualServo.Goal(reference="experiment"), feedback.append))
time.sleep(1.0)
done(unpause.call_async(Empty.Request()))
result = done(second.get_result_async())
image = came[NAMESPACE + "camera/image_raw"][-1]
print(json.dumps({
    "cancelled": cancelled.status, "status": result.status, "converged": result.result.converged,
    "reason": result.result.reason, "features": list(result.result.feature_names),
    "phases": sorted({message.feedback.state.phase for message in feedback}),
    "came": {topic: len(messages) for topic, messages in came.items()},
    "image": [image.width, image.height, image.encoding, len(image.data)],
    "k": list(came[NAMESPACE + "camera/camera_info"][-1].k),
    "joints": list(came[NAMESPACE + "joint_states"][-1].name)}), flush=True)
