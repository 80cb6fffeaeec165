"""Makes the features of a bag's images again and compares them with the recorded ones, bit for bit. No ROS master.

    result = replay("run.bag")
    print(result.text())
"""

import math
from dataclasses import dataclass
from typing import Any, Optional

from aras_visual_servo import Scenario, image_of, known_sources
from .bag import camera_info_of, decode_depth, find_topics, settings_of
from .files import BagError, BagFiles

ALWAYS = "camera/features"              # the camera node makes these of every image
NEEDED = ("camera/image_raw", ALWAYS, "camera/camera_info")
DEPTH = "camera/depth/image_raw"        # where a source wants depths; it comes before the image of the same stamp
# age_s is a matter of when the node ran; a reference taught before the bag begins is known by its numbers only.
NOT_COMPARED = ("header", "age_s", "reference_stamp_ns")


@dataclass(frozen=True)
class Replay:
    """Result of a replay.

    Attributes:
        images: number of images that were compared.  differences: lines "t, field: recorded, again".
        alone: number of images without recorded features and of features without their image.
    """

    images: int
    differences: tuple
    alone: int = 0

    @property
    def same(self) -> bool:
        """Whether images were compared and all of them gave the recorded features."""
        return self.images > 0 and not self.differences

    def text(self) -> str:
        """The result in one line, and up to five differences in lines of their own."""
        if not self.images:
            return "replay: no image has recorded features of its stamp"
        alone = f" ({self.alone} without a partner)" if self.alone else ""
        if self.same:
            return f"replay: {self.images} images{alone} give the recorded features, bit for bit"
        lines = [f"replay: {len(self.differences)} values of {self.images} images{alone} differ from the recorded ones"]
        return "\n".join(lines + [f"  {line}" for line in self.differences[:5]])


def replay(paths: Any, namespace: Optional[str] = None, scenario: Optional[Scenario] = None) -> Replay:
    """Process the images of a bag again, with the camera and the vision settings of the run.

    Args: paths, namespace, scenario: see `bag.read_bag`.
    Returns: Replay.
    Raises: BagError: images, features or camera_info were not recorded, or the settings are unknown.
    """
    with BagFiles(paths) as bags:
        topics = find_topics(bags, namespace)
        missing = [name for name in NEEDED if name not in topics]
        if missing:
            raise BagError(f"replay of '{bags.name}': not recorded: {', '.join(missing)}; record the groups images and "
                           "features")
        sources = [source for source in known_sources() if source.topic in topics and not source.from_elsewhere]
        recorded, info, document = {source.topic: {} for source in sources}, None, None
        names = {topics[name]: name for name in (*recorded, "camera/camera_info", "scenario") if name in topics}
        for topic, message in bags.messages(names):
            if names[topic] in recorded:
                recorded[names[topic]][message.header.stamp.to_nsec()] = message
            elif names[topic] == "scenario":
                document = message.data
            else:
                info = info or camera_info_of(message)
        settings, _ = settings_of(scenario, document, [])
        if "vision" not in settings:
            raise BagError(f"replay of '{bags.name}': the bag does not hold the scenario, whose section vision is "
                           "needed; give --scenario")
        vision = settings["vision"]
        compared = {source.topic: _Comparison(source, source.extractor(info or {}, vision), recorded[source.topic])
                    for source in sources if not source.section or source.section in vision}
        image_topic, depth, depth_ns = topics["camera/image_raw"], None, None
        depth_topic = image_topic[:-len("camera/image_raw")] + DEPTH
        wanted = [source.topic for source in sources if source.topic in compared and source.wants_depth(vision)]
        if wanted and depth_topic not in bags.topics:
            raise BagError(f"replay of '{bags.name}': not recorded: {DEPTH}; record the group depth, too")
        for topic, message in bags.messages([image_topic, depth_topic] if wanted else [image_topic]):
            stamp_ns = message.header.stamp.to_nsec()
            if topic != image_topic:
                depth, depth_ns = decode_depth(message), stamp_ns
                continue
            image = image_of(message)
            for name, comparison in compared.items():
                comparison.add(stamp_ns, image, *((depth,) if name in wanted and depth_ns == stamp_ns else ()))
    differences = tuple(difference for comparison in compared.values() for difference in comparison.differences)
    always = compared[ALWAYS]
    return Replay(always.images, differences, always.alone + len(recorded[ALWAYS]) - always.images)


class _Comparison:
    """Compares the features of a source, recomputed from the images, with the recorded ones."""

    def __init__(self, source, extractor, recorded):
        self._source, self._extractor, self._recorded = source, extractor, recorded
        self._reference = None
        self.images, self.alone, self.differences = 0, 0, []

    def add(self, stamp_ns, image, *depth):
        """Compare the features of the next image with the recorded ones of its stamp. Args: depth: its depth image."""
        message = self._recorded.get(stamp_ns)
        if message is None:
            self.alone += 1
            self._extractor.process(image, stamp_ns, *depth)
            return
        self._follow_reference(message)
        features = self._extractor.process(image, stamp_ns, *depth)
        self.images += 1
        for name in message.__slots__:
            if name not in NOT_COMPARED:
                was, now = getattr(message, name), getattr(features, name)
                if not same(was, now):
                    self.differences.append(f"{stamp_ns * 1e-9:.6f} s, {name}: recorded {was}, again {now}")

    def _follow_reference(self, message):
        """Features say which image was taught for them, and how far the target was in it."""
        fields = self._source.tell_reference
        told = tuple(getattr(message, field) for field in fields) if message.has_reference else None
        if told == self._reference:
            return
        self._reference = told
        if told is None:
            self._extractor.clear_reference()
            return
        from aras_visual_servo_camera import ArasError
        try:
            self._extractor.teach(message.reference_stamp_ns, message.z_star_m)
        except ArasError:  # given as numbers, or taught before the bag begins
            self._source.follow(self._extractor, message)


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal to the last bit, sequences element by element. NaN is equal to NaN."""
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float) and isinstance(b, float) and math.isnan(a):
        return math.isnan(b)
    return a == b
