"""Where features come from: what the camera makes of an image. One file of this folder is one source:

    @register_source("mine")
    class Mine(Source):
        topic, message = "camera/mine", "my_msgs/MyFeatures"
        def extractor(self, camera_info, vision): ...
        def taught(self, features, z_star_m, normal_C): ...
        def follow(self, extractor, features): ...

A feature names its source (`Feature.source`); the servo, the loop in process, the nodes and the bags ask the source for
everything else they need, so that none of them knows one by name. Names of ROS are plain text here, nothing of ROS is
imported.
"""

from typing import Any, NamedTuple, Optional

import numpy as np

from ...config.plugins import load_room
from ...ground.errors import ParameterError
from ...ground.types import Features

_SOURCES = {}


def register_source(name):
    """Class decorator: make a source known by name."""

    def add(source):
        source.name = name
        _SOURCES[name] = source()
        return source

    return add


def known_sources():
    """The registered sources, sorted by name."""
    load_room(__package__)
    return [_SOURCES[name] for name in sorted(_SOURCES)]


def source_named(name):
    """The `Source` of that name. Raises ParameterError, listing the known ones."""
    for source in known_sources():
        if source.name == name:
            return source
    raise ParameterError(f"source: found '{name}', allowed {', '.join(source.name for source in known_sources())}")


class Taught(NamedTuple):
    """A view as the goal sees itself.

    Attributes:
        features: of the view, relative to itself: the wanted values are theirs.
        view, plane_C: what a `Reference` keeps of them; None: nothing.
    """

    features: Any
    view: Optional[Features] = None
    plane_C: Optional[np.ndarray] = None


class Source:
    """One source of features. What it makes of an image is "features" here: an object with attributes, among them
    `target_visible` and `valid`; over ROS a message with the same fields.

    Features of a bag tell which image they are relative to: `has_reference`, `reference_stamp_ns`, `z_star_m`.

    Attributes:
        name.  topic, message: of its features over ROS; recorded with the group `features`.
        tell_reference: fields of the features that tell one reference from another.
        section: key of the scenario's `vision` that makes the camera node publish them; "": it always does, or another
            node makes them.
    """

    name, topic, message, section = "", "", "", ""
    tell_reference = ("reference_stamp_ns", "z_star_m")

    def extractor(self, camera_info, vision):
        """What makes them in process.

        Args: camera_info: dict.  vision: the scenario's section (dict).
        Returns: an object with process(image, stamp_ns) -> features, clear_reference(), and teach(stamp_ns, z_star_m):
            the image of this stamp, one of the last, is the reference from then on.
        """
        raise NotImplementedError

    def why_lost(self, features):
        """What is wrong with features that are not fit to servo on; "": they are."""
        if features.target_visible and features.valid:
            return ""
        return "target not in view" if not features.target_visible else "features not valid"

    def taught(self, features, z_star_m, normal_C):
        """`Taught` of features that are fit to servo on, whatever reference they have themselves.

        Args: z_star_m: depth of the target in this view [m].  normal_C: normal of its plane in the camera frame.
        """
        raise NotImplementedError

    def follow(self, extractor, features):
        """Give an extractor the reference of these features, as far as they tell: its image is not there any more."""
        extractor.clear_reference()
