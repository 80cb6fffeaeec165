"""Runs and sweeps as HDF5 and MCAP, read back with the libraries of these formats."""
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np
import pytest
import yaml
from mcap.reader import make_reader

import aras_visual_servo as avs
from aras_visual_servo.cli.main import main
from aras_visual_servo_learning.command import export_main

STARTS = 3


@pytest.fixture(scope="module")
def record():
    return avs.run(avs.load_scenario("experiment_1"), keep_images=True)


@pytest.fixture(scope="module")
def hdf5(tmp_path_factory):
    path = tmp_path_factory.mktemp("export") / "runs.hdf5"
    assert export_main(["experiment_1", "experiment_2", "--to", str(path), "--images"]) == 0
    return path


def test_the_layout_is_robomimics(hdf5):
    with h5py.File(hdf5, "r") as file:
        data = file["data"]
        assert sorted(data) == ["demo_0", "demo_1"]
        assert data.attrs["total"] == sum(data[name].attrs["num_samples"] for name in data)
        arguments = json.loads(data.attrs["env_args"])
        assert set(arguments) == {"env_name", "type", "env_kwargs"}
        for demo in data.values():
            n = demo.attrs["num_samples"]
            for name in ("actions", "rewards", "dones", "states"):
                assert len(demo[name]) == n
            assert set(demo["obs"]) == set(demo["next_obs"]) == {
                "joint_positions", "camera_pose", "features", "feature_errors", "image"}
            for name in demo["obs"]:
                assert np.array_equal(demo["obs"][name][1:], demo["next_obs"][name][:-1])
            assert demo["dones"][-1] == 1 and not demo["dones"][:-1].any()
        masks = {name: [demo.decode() for demo in file["mask"][name]] for name in ("train", "valid")}
        assert sorted(masks["train"] + masks["valid"]) == sorted(data)


def test_the_numbers_are_those_of_the_run(hdf5, record):
    rows = record.servo_rows
    with h5py.File(hdf5, "r") as file:
        demo = file["data/demo_0"]
        assert np.array_equal(demo["actions"], record.twist[rows][:-1])
        assert np.array_equal(demo["obs/joint_positions"], record.q[rows][:-1])
        assert np.array_equal(demo["next_obs/feature_errors"], record.e[rows][1:])
        assert np.array_equal(demo["obs/image"][7], record.images[rows[7]])
        final = avs.judge(record).final_error
        assert 1e3 * demo["next_obs/camera_pose"][-1][:3] == pytest.approx(
            [final["x_mm"], final["y_mm"], final["z_mm"]], abs=1e-6)  # rounding
        assert demo["rewards"][-1] > 0.9 > 0.0 > demo["rewards"][0]
        assert yaml.safe_load(demo.attrs["scenario"])["name"] == "experiment_1"


def test_a_sweep_gives_one_demonstration_a_run(tmp_path):
    assert main(["sweep", "experiment_1", "--starts", str(STARTS), "--workers", "0", "--output", str(tmp_path),
                 "--name", "few"]) == 0
    folder = tmp_path / "sweeps" / "experiment_1" / "few"
    assert export_main([str(folder), "--to", str(tmp_path / "sweep.hdf5")]) == 0
    with h5py.File(tmp_path / "sweep.hdf5", "r") as file:
        runs = [demo.attrs["run"] for demo in file["data"].values()]
        assert runs == [f"run_{i + 1}" for i in range(STARTS)]
        assert len({demo["obs/joint_positions"][0].tobytes() for demo in file["data"].values()}) == STARTS
    assert export_main([str(folder), "--to", str(tmp_path / "sweep.mcap")]) == 0
    with open(tmp_path / "sweep.mcap", "rb") as stream:
        assert {channel.topic for _, channel, _ in make_reader(stream).iter_messages()} == {
            f"run_{i + 1}/servo" for i in range(STARTS)}


def test_mcap_has_one_message_an_image(tmp_path, record):
    assert export_main(["experiment_1", "--to", str(tmp_path / "run.mcap")]) == 0
    with open(tmp_path / "run.mcap", "rb") as stream:
        messages = [(schema, json.loads(message.data)) for schema, _, message in make_reader(stream).iter_messages()]
    assert len(messages) == len(record) and messages[0][0].encoding == "jsonschema"
    for row in (0, len(record) // 2, len(record) - 1):
        found = messages[row][1]
        assert found["stamp_ns"] == record.stamp_ns[row] and found["phase"] == record.phase[row]
        assert list(found["joint_positions"].values()) == record.q[row].tolist()
        assert found["camera_pose_world"] == record.X_WC[row].tolist()


def test_every_message_of_a_bag_is_copied(tmp_path):
    import rosbag
    from rospy import Time
    from std_msgs.msg import String
    with rosbag.Bag(str(tmp_path / "run.bag"), "w") as bag:
        for i in range(5):
            bag.write("/said" if i % 2 else "/heard", String(f"word {i}"), Time(i))
    assert export_main([str(tmp_path / "run.bag"), "--to", str(tmp_path / "run.mcap")]) == 0
    with open(tmp_path / "run.mcap", "rb") as stream:
        messages = list(make_reader(stream).iter_messages())
    assert len(messages) == 5
    for i, (schema, channel, message) in enumerate(messages):
        assert (schema.name, schema.encoding, channel.message_encoding) == ("std_msgs/String", "ros1msg", "ros1")
        assert b"string data" in schema.data and message.log_time == i * 10**9
        assert String().deserialize(message.data).data == f"word {i}"


def test_bad_input_is_named_and_leaves_no_file(tmp_path, capsys):
    for arguments, said in ((["experiment_1", "--to", "runs.zip"], "--to: found 'runs.zip', allowed NAME.hdf5"),
                            (["experiment_99", "--to", "x.hdf5"], "experiment_99"),
                            (["experiment_1", "--to", "x.mcap", "--images"], "allowed with .hdf5 only")):
        arguments[2] = str(tmp_path / arguments[2])
        said = said.replace("'runs.zip'", f"'{tmp_path}/runs.zip'")
        assert export_main(arguments) == 2 and said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("module, code", [
    ("mcap", "from aras_visual_servo_learning.command import export_main; import sys; "
             "sys.exit(export_main(['experiment_1', '--to', 'x.mcap']))"),
    ("h5py", "from aras_visual_servo_learning.command import export_main; import sys; "
             "sys.exit(export_main(['experiment_1', '--to', 'x.hdf5']))"),
    ("gymnasium", "import aras_visual_servo_learning.environment")])
def test_what_is_missing_is_said_in_one_sentence(tmp_path, module, code):
    hide = f"import sys; sys.modules[{module!r}] = None; sys.modules['{module}.writer'] = None; "
    result = subprocess.run([sys.executable, "-c", hide + code], cwd=tmp_path, stderr=subprocess.PIPE, timeout=240)
    assert result.returncode
    assert result.stderr.decode().splitlines()[-1].count("which `script/bootstrap --extras` installs") == 1
    assert list(pathlib.Path(tmp_path).iterdir()) == []


def test_a_bag_becomes_one_of_ros2(tmp_path, capsys):
    import rosbag
    from rosbags.highlevel import AnyReader
    from rospy import Time
    from sensor_msgs.msg import CameraInfo
    from visualization_msgs.msg import Marker
    info = CameraInfo(height=3, width=4, K=[float(i) for i in range(9)], D=[0.5])
    info.header.stamp, info.header.frame_id = Time(1, 2), "camera"
    with rosbag.Bag(str(tmp_path / "run.bag"), "w") as bag:
        bag.write("/info", info, Time(5))
        bag.write("/marker", Marker(ns="target", id=3), Time(6))  # whose fields in ROS 2 are others
    target = tmp_path / "run.rosbag2"
    assert export_main([str(tmp_path / "run.bag"), "--to", str(target)]) == 0
    assert sorted(path.name for path in target.iterdir()) == ["metadata.yaml", "run.rosbag2.mcap"]
    with AnyReader([target]) as reader:
        (first, marker) = [(connection, time, reader.deserialize(data, connection.msgtype))
                           for connection, time, data in reader.messages()]
    connection, time_ns, message = first
    assert (connection.topic, connection.msgtype, time_ns) == ("/info", "sensor_msgs/msg/CameraInfo", 5 * 10**9)
    assert (message.header.stamp.nanosec, message.header.frame_id, message.width) == (2, "camera", 4)
    assert message.k.tolist() == info.K and message.d.tolist() == [0.5]
    assert (marker[2].ns, marker[2].id, marker[2].mesh_file.filename) == ("target", 3, "")
    assert export_main([str(tmp_path / "run.bag"), "--to", str(target)]) == 2
    assert export_main(["experiment_1", "--to", str(tmp_path / "other.rosbag2")]) == 2
    assert "is there already" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.bag", "run.rosbag2"]
