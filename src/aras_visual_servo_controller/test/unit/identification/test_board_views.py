"""A calibration board in the images of a bag, and what `identify --board` refuses."""
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState

from aras_visual_servo import ParameterError
from aras_visual_servo.cli.main import main
from aras_visual_servo_controller.bags.any_bag import AnyBag
from aras_visual_servo_controller.identification.board_views import read_board_views
from aras_visual_servo_controller.calibration.boards import Board

sys.path.insert(0, str(Path(__file__).parents[1] / "bags"))
from test_joint_log import TIMES, state, write

BOARD = Board("circles", 3, 5, 0.02)
SO101 = ("elbow_flex", "shoulder_lift", "shoulder_pan", "wrist_flex", "wrist_roll")


def image(t, blank=False):
    picture = np.full((240, 320), 255, dtype=np.uint8)
    for outline in [] if blank else BOARD.outlines():
        cv2.fillPoly(picture, [np.round(np.array(outline) * 1500.0 + 80.0).astype(np.int32)], 0)
    message = Image(height=240, width=320, encoding="mono8", step=320, data=picture.tobytes())
    message.header.stamp = rospy.Time.from_sec(float(t))
    return message


def views(name="/cam", info=True, blank=False):
    found = [(f"{name}/image_raw", image(t, blank), t) for t in TIMES[:3]]
    lens = CameraInfo(width=320, height=240, K=[200.0, 0, 160, 0, 200, 120, 0, 0, 1], D=[0.0] * 5,
                      distortion_model="plumb_bob")
    return found + ([(f"{name}/camera_info", lens if info is True else info, TIMES[0])] if info else [])


def read(path, **options):
    with AnyBag(path) as bag:
        return read_board_views(bag, BOARD, **options)


def test_the_board_is_found_with_the_stamps_and_the_lens_of_the_camera(tmp_path):
    camera, stamps, pixels = read(write(tmp_path / "a.bag", views()))
    np.testing.assert_allclose(stamps, TIMES[:3])
    assert pixels.shape == (3, 15, 2)
    np.testing.assert_allclose(pixels[0], BOARD.points_m[:, :2] * 1500.0 + 80.0, atol=1.0)
    assert camera.K[0, 0] == 200.0 and camera.distortion.tolist() == [0.0] * 5 and camera.width == 320


def compressed(data=None):
    """The views with PNG files in the place of the images, or with these bytes."""
    found = []
    for topic, message, t in views():
        if topic.endswith("image_raw"):
            pixels = np.frombuffer(message.data, dtype=np.uint8).reshape(240, 320)
            packed = CompressedImage(header=message.header, format="mono8; png compressed",
                                     data=data or cv2.imencode(".png", pixels)[1].tobytes())
            topic, message = topic + "/compressed", packed
        found.append((topic, message, t))
    return found


def test_compressed_images_tell_the_same_as_the_images_they_were_made_of(tmp_path):
    camera, stamps, pixels = read(write(tmp_path / "c.bag", compressed()))
    plain = read(write(tmp_path / "a.bag", views()))
    np.testing.assert_array_equal(pixels, plain[2])
    np.testing.assert_array_equal(stamps, plain[1])
    assert camera.K[0, 0] == 200.0


@pytest.mark.parametrize("messages, words", [
    (lambda: compressed(b"12345678"), "/cam/image_raw/compressed: found an image of format"),
    (lambda: views(info=None), "/cam/camera_info: found none"),
    (lambda: views(info=CameraInfo()), "found no intrinsics"),
    (lambda: views() + views("/other"), "/cam/image_raw, /other/image_raw"),
    (lambda: [("/clock", JointState(), 1.0)], "no topic, allowed one"),
    (lambda: views(blank=True), "in none of 3 images")])
def test_images_that_cannot_be_used_are_named(tmp_path, messages, words):
    with pytest.raises(ParameterError) as error:
        read(write(tmp_path / "b.bag", messages()))
    assert words in str(error.value)


def test_images_without_camera_info_leave_nothing_written(tmp_path, capsys):
    told = [("/arm/joint_command", state(t, np.zeros(5), SO101), t) for t in TIMES]
    states = [("/arm/joint_states", state(t, 0.2 * np.sin(t) * np.ones(5), SO101), t) for t in TIMES]
    path = write(tmp_path / "c.bag", states + told + views(info=None))
    out = str(tmp_path / "out")
    assert main(["identify", path, "--robot", "so101", "--out", out, "--board", "circles"]) == 2
    errors = capsys.readouterr().err
    assert all(f"--{key}:" in errors for key in ("columns", "rows", "size-m"))
    board = ["--board", "circles", "--columns", "3", "--rows", "5", "--size-m", "0.02"]
    assert main(["identify", path, "--robot", "so101", "--out", out, *board]) == 2
    assert "/cam/camera_info: found none" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
