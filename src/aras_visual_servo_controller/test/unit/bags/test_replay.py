"""A bag's images through the extractor again: the same features, bit for bit; a changed bit is found."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

rosbag = pytest.importorskip("rosbag")
rospy = pytest.importorskip("rospy")
camera = pytest.importorskip("aras_visual_servo_camera")
import yaml  # noqa: E402
from aras_visual_servo_msgs.msg import MomentFeatures, PhotometricFeatures, ServoState  # noqa: E402
from sensor_msgs.msg import CameraInfo  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from messages import image_message

from aras_visual_servo_controller.bags.bag import BagError  # noqa: E402
from aras_visual_servo_controller.bags.replay import replay, same  # noqa: E402

VISION = {"object": "dark", "segmentation": "coverage"}
LUMINANCE = {**VISION, "photometric": {"levels": 2, "border_px": 4}}
INFO = {"width": 64, "height": 48, "K": [100.0, 0, 31.5, 0, 100.0, 23.5, 0, 0, 1], "D": [0.0] * 5,
        "distortion_model": "plumb_bob", "P": [0.0] * 12, "R": [1.0, 0, 0, 0, 1, 0, 0, 0, 1], "frame_id": "camera"}
TAUGHT, IMAGES = 3, 8
TAUGHT_NS = (TAUGHT + 1) * 1_000_000_000


def wedge(k):
    image = np.full((48, 64), 230, np.uint8)
    for row in range(12):
        image[14 + row, 14 + k:14 + k + 2 * (row + 1)] = 20
    return np.repeat(image[..., None], 3, axis=2)


def texture(k):
    u, v = np.meshgrid(np.arange(64) - 0.3 * k, np.arange(48))
    grey = np.rint(128 + 50 * np.sin(0.3 * u + 0.1 * v) + 50 * np.cos(0.25 * v)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def write(path, change=None, without=(), vision=VISION, late=0, first=0):
    """What a camera node would have published for IMAGES images, the view TAUGHT made the reference `late` images on.

    Images before the `first` are not in the bag. With vision.photometric the images are textures, and `change` is that
    of the photometric features.
    """
    extractors = [("features", MomentFeatures, camera.MomentExtractor(INFO, vision))]
    if "photometric" in vision:
        extractors.append(("photometric", PhotometricFeatures,
                           camera.PhotometricExtractor(INFO, vision["photometric"])))
    with rosbag.Bag(str(path), "w") as bag:
        def put(topic, message, stamp):
            if topic not in without:
                if hasattr(message, "header"):
                    message.header.stamp = stamp
                bag.write("/a/" + topic, message, stamp)

        put("scenario", String(yaml.safe_dump({"name": "x", "vision": vision})), rospy.Time(0, 1))
        put("camera/camera_info", CameraInfo(**{key: INFO[key] for key in ("width", "height", "K", "D", "P", "R",
                                                                           "distortion_model")}), rospy.Time(0, 1))
        for k in range(IMAGES):
            stamp, image = rospy.Time(k + 1), (texture if "photometric" in vision else wedge)(k)
            messages = []
            for name, kind, extractor in extractors:
                seen = extractor.process(image, stamp.to_nsec())
                messages.append((name, kind(**{key: getattr(seen, key) for key in kind.__slots__
                                               if hasattr(seen, key)})))
            if k == TAUGHT + late:
                extractors[-1][2].teach(TAUGHT_NS, 0.59)
            if k < first:
                continue
            if k == change:
                last = messages[-1][1]
                if "photometric" in vision:
                    last.b = [value + 1e-9 * abs(value) for value in last.b]
                else:
                    last.xg = math.nextafter(last.xg, 1.0)
            put("camera/image_raw", image_message(image, stamp), stamp)
            for name, message in messages:
                put(f"camera/{name}", message, stamp)
            put("servo_state", ServoState(phase="servo"), stamp)
    return path


@pytest.mark.parametrize("late", [0, 2])
def test_photometric_features_are_replayed_with_their_reference(tmp_path, late):
    result = replay(write(tmp_path / "run.bag", vision=LUMINANCE, late=late))
    assert result.same and result.images == IMAGES, result.text()


def test_one_changed_value_of_photometric_features_is_found(tmp_path):
    changed = replay(write(tmp_path / "changed.bag", vision=LUMINANCE, change=IMAGES - 1))
    assert [line.split(":")[0] for line in changed.differences] == [f"{IMAGES}.000000 s, b"]


@pytest.mark.parametrize("late", [0, 2])
def test_the_same_images_give_the_same_features_bit_for_bit(tmp_path, late):
    result = replay(write(tmp_path / "run.bag", late=late))
    assert result.same and result.images == IMAGES and result.alone == 0, result.text()
    assert "8 images give the recorded features" in result.text()


def test_a_reference_taught_before_the_bag_begins_is_taken_from_the_features(tmp_path):
    result = replay(write(tmp_path / "run.bag", first=TAUGHT + 1))
    assert result.same and result.images == IMAGES - TAUGHT - 1, result.text()


def test_points_are_replayed_too(tmp_path):
    points = dict(VISION, points="blobs", point_count=1, min_area_px=20)
    path = write(tmp_path / "run.bag", vision=points)
    with rosbag.Bag(str(path)) as bag:
        assert all(len(message.point_x) == 1 for _, message, _ in bag.read_messages("/a/camera/features"))
    assert replay(path).same
    other = SimpleNamespace(as_dict=lambda: {"vision": VISION}, name="without points")
    assert len(replay(path, scenario=other).differences) >= 2 * IMAGES


def test_one_changed_bit_is_found_and_named(tmp_path):
    result = replay(write(tmp_path / "run.bag", change=5))
    assert not result.same and len(result.differences) == 1
    assert result.differences[0].startswith("6.000000 s, xg: recorded")


def test_a_bag_without_images_cannot_be_replayed_and_says_what_to_record(tmp_path):
    path = write(tmp_path / "run.bag", without=("camera/image_raw",))
    with pytest.raises(BagError, match="not recorded: camera/image_raw; record the groups images and features"):
        replay(path)


def test_a_bag_that_does_not_say_how_it_was_looked_at_needs_the_scenario(tmp_path):
    with pytest.raises(BagError, match="give --scenario"):
        replay(write(tmp_path / "run.bag", without=("scenario",)))


def test_not_a_number_is_the_same_as_itself_and_as_nothing_else():
    assert same([math.nan, 1.0], [math.nan, 1.0]) and not same(math.nan, 1.0) and not same([1.0], [1.0, 2.0])
