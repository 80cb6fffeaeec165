"""Joint states of a rosbag2 and of an MCAP file, which the library rosbags reads."""
import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from aras_visual_servo_controller.bags.any_bag import AnyBag
from aras_visual_servo_controller.bags.joint_log import read_joint_log


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_joint_states_of_ros_2_are_read(tmp_path, storage):
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    with Writer(tmp_path / "bag", version=9, storage_plugin=storage) as writer:
        topics = {topic: writer.add_connection(topic, "sensor_msgs/msg/JointState", typestore=store)
                  for topic in ("/joint_states", "/joint_command")}
        for k in range(100):
            stamp = kinds["builtin_interfaces/msg/Time"](sec=5, nanosec=k * 10_000_000)
            header = kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="")
            for topic, connection in topics.items():
                message = kinds["sensor_msgs/msg/JointState"](
                    header=header, name=["J2", "J1"], position=np.array([2.0, 1.0]) * k, velocity=np.array([]),
                    effort=np.array([]))
                writer.write(connection, 5_000_000_000 + k * 10_000_000, store.serialize_cdr(
                    message, "sensor_msgs/msg/JointState"))
    with AnyBag(str(tmp_path / "bag")) as bag:
        log = read_joint_log(bag, ("J1", "J2"), {}, step_s=0.001)
    np.testing.assert_allclose(log.times_s, 5.0 + 0.01 * np.arange(100))
    np.testing.assert_allclose(log.position, np.outer(np.arange(100), (1.0, 2.0)))
    assert log.kind == "position" and log.told.shape == (100, 2)
