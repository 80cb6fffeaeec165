"""Computes the features of a bag's images again and compares them with the recorded ones, bit for bit. No ROS master.

    result = replay("run.bag")
    print(result.text())
"""

import math
from dataclasses import dataclass

from .bag import camera_info_of, decode, find_topics, settings_of
from .files import BagError, BagFiles

NEEDED = ("camera/image_raw", "camera/features", "camera/camera_info")
NOT_COMPARED = ("header", "age_s")      # age_s depends on when the node ran


@dataclass(frozen=True)
class Replay:
    """What a replay found.

    Attributes:
        images: number of images that were compared.  differences: lines "t, field: recorded, again".
        alone: number of images without recorded features and of features without their image.
    """

    images: int
    differences: tuple
    alone: int = 0

    @property
    def same(self):
        """Whether images were compared and all of them gave the recorded features."""
        return self.images > 0 and not self.differences

    def text(self):
        """The result in one line, and up to five differences in lines of their own."""
        if not self.images:
            return "replay: no image has recorded features of its stamp"
        alone = f" ({self.alone} without a partner)" if self.alone else ""
        if self.same:
            return f"replay: {self.images} images{alone} give the recorded features, bit for bit"
        lines = [f"replay: {len(self.differences)} values of {self.images} images{alone} differ from the recorded ones"]
        return "\n".join(lines + [f"  {line}" for line in self.differences[:5]])


def replay(paths, namespace=None, scenario=None):
    """Process the images of a bag again, with the camera and the vision settings of the run.

    Args:
        paths, namespace, scenario: see `bag.read_bag`.
    Returns:
        Replay.
    Raises:
        BagError: images, features or camera_info were not recorded, or the settings are unknown.
    """
    from aras_visual_servo_camera import MomentExtractor, PhotometricExtractor
    with BagFiles(paths) as bags:
        topics = find_topics(bags, namespace)
        missing = [name for name in NEEDED if name not in topics]
        if missing:
            raise BagError(f"replay of '{bags.name}': not recorded: {', '.join(missing)}; record the groups images and "
                           "features")
        recorded, photometric, info, document = {}, {}, None, None
        wanted = ("camera/features", "camera/photometric", "camera/camera_info", "scenario")
        names = {topics[name]: name for name in wanted if name in topics}
        for topic, message in bags.messages(names):
            if names[topic] == "camera/features":
                recorded[message.header.stamp.to_nsec()] = message
            elif names[topic] == "camera/photometric":
                photometric[message.header.stamp.to_nsec()] = message
            elif names[topic] == "scenario":
                document = message.data
            else:
                info = info or camera_info_of(message)
        settings, _ = settings_of(scenario, document, [])
        if "vision" not in settings:
            raise BagError(f"replay of '{bags.name}': how the images were looked at is unknown; give --scenario")
        compared = [_Comparison(MomentExtractor(info, settings["vision"]), recorded)]
        if photometric and "photometric" in settings["vision"]:
            extractor = PhotometricExtractor(info, settings["vision"]["photometric"])
            compared.append(_PhotometricComparison(extractor, photometric))
        for _, message in bags.messages([topics["camera/image_raw"]]):
            image = decode(message)
            for comparison in compared:
                comparison.add(message.header.stamp.to_nsec(), image)
    differences = tuple(difference for comparison in compared for difference in comparison.differences)
    moments = compared[0]
    return Replay(moments.images, differences, moments.alone + len(recorded) - moments.images)


class _Comparison:
    def __init__(self, extractor, recorded):
        self._extractor, self._recorded = extractor, recorded
        self._reference, self._before = None, None
        self.images, self.alone, self.differences = 0, 0, []

    def add(self, stamp_ns, image):
        """Compare the features of the next image with the recorded ones of its stamp."""
        message = self._recorded.get(stamp_ns)
        if message is None:
            self.alone += 1
            self._before = self._kept(self._extractor.process(image), image)
            return
        self._follow_reference(message)
        features = self._extractor.process(image)
        self._before = self._kept(features, image)
        self.images += 1
        for name in message.__slots__:
            if name not in NOT_COMPARED:
                was, now = getattr(message, name), getattr(features, name)
                if not same(was, now):
                    self.differences.append(f"{stamp_ns * 1e-9:.6f} s, {name}: recorded {was}, again {now}")

    @staticmethod
    def _kept(features, image):
        """What is kept of an image, because the next message may show that it has become the reference."""
        return features

    def _follow_reference(self, message):
        """Set the extractor's reference to that of the message.

        Teaching itself is not recorded. A message with another reference than the one before tells that the image
        before it was taught, or that the reference was given as numbers.
        """
        reference = (message.z_star_m, message.area_star) if message.has_reference else None
        if reference == self._reference:
            return
        self._reference = reference
        if reference is None:
            self._extractor.clear_reference()
        elif self._before is not None and self._before.area == message.area_star:
            self._extractor.set_reference(message.z_star_m, self._before)
        else:  # given as numbers, or taught before the bag begins
            self._extractor.set_reference(message.z_star_m, message.area_star, message.alpha)


class _PhotometricComparison(_Comparison):
    @staticmethod
    def _kept(features, image):
        return image

    def _follow_reference(self, message):
        """Take the image before as reference when its hash changes. If it was another image, the values will differ."""
        reference = (message.reference_hash, message.z_star_m) if message.has_reference else None
        if reference == self._reference:
            return
        self._reference = reference
        if reference is None or self._before is None:
            self._extractor.clear_reference()
        else:
            self._extractor.set_reference(self._before, message.z_star_m)


def same(a, b):
    """Whether two values are equal to the last bit, sequences element by element. NaN is equal to NaN."""
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float) and isinstance(b, float) and math.isnan(a):
        return math.isnan(b)
    return a == b
