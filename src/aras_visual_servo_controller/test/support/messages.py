"""A record as the nodes would publish it: messages, and a bag written from them."""

import numpy as np
import rosbag
import rospy
import yaml
from aras_visual_servo_msgs.msg import MomentFeatures, ServoState, SimStatus
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String
from synthetic import SETTINGS, blob

from aras_visual_servo.spatial import quaternion_xyzw


NAMESPACE = "/somewhere/aras"


def pose_message(X, stamp):
    message = PoseStamped()
    message.header.stamp = stamp
    p, q = message.pose.position, message.pose.orientation
    p.x, p.y, p.z = X[:3, 3]
    q.x, q.y, q.z, q.w = quaternion_xyzw(X[:3, :3])
    return message


def image_message(image, stamp, encoding="rgb8", padding=0):
    rows = image.reshape(image.shape[0], -1)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    message = Image(height=image.shape[0], width=image.shape[1], encoding=encoding, step=rows.strides[0],
                    data=rows.tobytes())
    message.header.stamp = stamp
    return message


def state_message(record, i, stamp):
    message = ServoState(status=int(record.status[i]), status_text=str(record.status_text[i]),
                         phase=str(record.phase[i]))
    message.header.stamp = stamp
    # Another order than ours on purpose: features and joints travel by name.
    message.feature_names = ["alpha", "an", "yn", "xn"]
    message.s, message.s_star, message.e = record.s[i][::-1], record.s_star[i][::-1], record.e[i][::-1]
    v = message.twist
    v.linear.x, v.linear.y, v.linear.z, v.angular.x, v.angular.y, v.angular.z = record.twist[i]
    message.joint_names = list(record.joint_names[::-1])
    message.q, message.set_point = record.q[i][::-1], record.set_point[i][::-1]
    return message


def messages_of(record, skip=(), encoding="rgb8", padding=0, scenario=True):
    """(topic, message, stamp) of a record, as the nodes would publish them."""
    if scenario:
        yield "scenario", String(yaml.safe_dump(dict(SETTINGS, name="experiment_1"))), rospy.Time(0, 1)
    info = CameraInfo(width=64, height=48, K=[100, 0, 31.5, 0, 100, 23.5, 0, 0, 1])
    yield "camera/camera_info", info, rospy.Time(0, 1)
    for i in range(len(record)):
        stamp = rospy.Time(0, int(record.stamp_ns[i]) + 1) if record.stamp_ns[i] == 0 else rospy.Time(
            int(record.stamp_ns[i]) // 10**9, int(record.stamp_ns[i]) % 10**9)
        servo = i in record.servo_rows
        image = blob(8 - min(8, i - record.servo_rows[0])) if servo else blob(0)
        image = image[..., 0] if "mono" in encoding else image[..., ::-1] if encoding == "bgr8" else image
        image = image * np.uint16(257) if encoding.endswith("16") else image
        features = MomentFeatures(area=0.05, xg=0.0, yg=0.0, alpha=0.3)
        features.header.stamp = stamp
        yield "camera/image_raw", image_message(image, stamp, encoding, padding), stamp
        if i not in skip:
            yield "ground_truth/camera_pose", pose_message(record.X_WC[i], stamp), stamp
        yield "camera/features", features, stamp
        yield "servo_state", state_message(record, i, stamp), stamp
    status = SimStatus(real_time_factor=12.5, run_hash="feed", opengl="llvmpipe, 4.5")
    yield "sim/status", status, stamp


def write(path, messages, namespace=NAMESPACE, without=()):
    with rosbag.Bag(str(path), "w") as bag:
        for topic, message, stamp in messages:
            if topic not in without:
                bag.write(f"{namespace}/{topic}", message, stamp)
    return path
