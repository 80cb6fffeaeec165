"""Messages as CDR: against bytes written by hand, and there and back."""
import io
import math
import struct

import pytest
import rospy
from geometry_msgs.msg import TransformStamped, TwistStamped
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import String
from std_srvs.srv import EmptyRequest
from tf2_msgs.msg import TFMessage

from aras_visual_servo_controller.ros2.wire import WireError, definitions_of, fields_of, from_cdr, to_cdr
from aras_visual_servo_msgs.msg import MomentFeatures, PhotometricFeatures

NAN_WITH_A_PAYLOAD = struct.unpack("<d", bytes.fromhex("efbeadde0000f87f"))[0]


def ros1_bytes(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def stamped(message, seq=7):
    message.header.stamp, message.header.frame_id, message.header.seq = rospy.Time(3, 4), "ab", seq
    return message


def test_a_joint_state_has_the_bytes_that_the_standard_asks_for():
    message = stamped(JointState(name=["finger"], position=[NAN_WITH_A_PAYLOAD, 2.0]))
    assert to_cdr(JointState)(ros1_bytes(message), 0) == b"".join((
        b"\0\1\0\0",                                            # plain CDR, little endian
        struct.pack("<iI", 3, 4), struct.pack("<I", 3), b"ab\0", b"\0",  # stamp; frame with its zero; padding to 4
        struct.pack("<I", 1), struct.pack("<I", 7), b"finger\0", b"\0",
        struct.pack("<I", 2), b"\0" * 4,                        # doubles begin at a multiple of 8
        bytes.fromhex("efbeadde0000f87f"), struct.pack("<d", 2.0),
        struct.pack("<II", 0, 0)))                              # empty sequences are not aligned


@pytest.mark.parametrize("message", [
    stamped(Image(height=2, width=3, encoding="rgb8", step=9, data=bytes(range(18)))),
    stamped(CameraInfo(height=2, distortion_model="plumb_bob", D=[1.0] * 5, K=list(range(9)))),
    stamped(JointState(name=["a", "bcd", ""], position=[math.inf], effort=[1.0, 2.0])),
    stamped(MomentFeatures(valid=True, area=-0.0, moment_names=["00", "10"], m=[1.0], depth_fault="no depth")),
    stamped(PhotometricFeatures(H=[1.0] * 21, reference_hash=2**64 - 1, reference_stamp_ns=-1)),
    stamped(TwistStamped()), TFMessage([stamped(TransformStamped(), 0), stamped(TransformStamped(), 0)]), String("é"),
    EmptyRequest()], ids=lambda message: type(message).__name__)
def test_there_and_back_is_the_same(message):
    kind, data = type(message), ros1_bytes(message)
    assert from_cdr(kind)(to_cdr(kind)(data, 0), 7) == data


def test_bytes_that_do_not_fit_are_refused():
    data = to_cdr(JointState)(ros1_bytes(stamped(JointState(name=["J1"], position=[1.0]))), 0)
    for bad in (b"\0\0\0\0" + data[4:], *(data[:length] for length in range(4, len(data)))):
        with pytest.raises(WireError):
            from_cdr(JointState)(bad, 0)
    with pytest.raises(WireError):
        to_cdr(Image)(ros1_bytes(stamped(Image(data=bytes(9))))[:-1], 0)


def test_fields_have_the_names_and_types_of_ros2():
    assert fields_of(CameraInfo)[:6] == [("header", "std_msgs/Header"), ("height", "uint32"), ("width", "uint32"),
                                         ("distortion_model", "string"), ("d", "sequence<double>"), ("k", "double[9]")]
    assert ("h", "sequence<double>") in fields_of(PhotometricFeatures)
    definitions = definitions_of(TFMessage)
    assert definitions["tf2_msgs/msg/TFMessage"] == "geometry_msgs/TransformStamped[] transforms\n"
    assert definitions["std_msgs/msg/Header"] == "builtin_interfaces/Time stamp\nstring frame_id\n"
