"""Sources of features. A source computes features from an image. Each file of this folder is one source:

    @register_source("mine")
    class Mine(Source):
        topic, message = "camera/mine", "my_msgs/MyFeatures"
        def extractor(self, camera_info, vision): ...
        def taught(self, features, z_star_m, normal_C): ...
        def follow(self, extractor, features): ...

A feature names its source (`Feature.source`). The servo, the loop in process, the nodes and the bags use this interface
only. Topics and message types are plain text; this package imports nothing of ROS.
"""

from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Type, TypeVar

import numpy as np

from ...ground.registry import Registry
from ...ground.types import Features

SOURCES: Registry["Source"] = Registry("source", __package__)
S = TypeVar("S", bound="Source")


def register_source(name: str) -> Callable[[Type[S]], Type[S]]:
    """Returns a class decorator that makes a source known by name."""
    def add(source: Type[S]) -> Type[S]:
        source.name = name
        SOURCES[name] = source()
        return source

    return add


def known_sources() -> List["Source"]:
    """Returns the registered sources, sorted by name."""
    return list(SOURCES.values())


def source_named(name: str) -> "Source":
    """Returns the `Source` of that name. Raises ParameterError with the nearest name."""
    return SOURCES.find(name)


class Taught(NamedTuple):
    """Reference data of a taught view.

    Attributes:
        features: features of the view measured with the view itself as the reference. Their values are s_star.
        view: `Features` that the `Reference` keeps, None if the source has none.
        plane_C: (3,) plane (A, B, C) that the `Reference` keeps [1/m], None if the source has none.
    """

    features: Any
    view: Optional[Features] = None
    plane_C: Optional[np.ndarray] = None


class Source:
    """Base class of the sources.

    What a source computes from an image is called "features" here: an object with attributes, among them
    `target_visible` and `valid`; over ROS it is a message with the same fields. In a bag the fields `has_reference`,
    `reference_stamp_ns` and `z_star_m` say which image was the reference of the features.

    Attributes:
        name: under which the source is registered.
        topic, message: ROS topic and type of its features; they are recorded with the group `features`.
        tell_reference: names of the fields in which features with different references differ.
        extractor_class: name of a class of the camera package, which computes the features.
        section: key of the scenario's section `vision` that makes the camera node publish them; "" if no key is needed.
        sees_parts: a part of the target in view is enough.
        averages: a goal can be the mean of several images; else it is one image, whose noise stays in it.
        from_elsewhere: another node makes the features (`Elsewhere`).
    """

    name, topic, message, extractor_class, section, sees_parts = "", "", "", "", "", False
    averages, from_elsewhere = True, False
    tell_reference: Tuple[str, ...] = ("reference_stamp_ns", "z_star_m")

    def extractor(self, camera_info: Mapping[str, Any], vision: Mapping[str, Any]) -> Any:
        """The object that computes features from images when everything runs in one process.

        The `extractor_class` of the camera package; a source from elsewhere makes its own.
        Args: camera_info: dict with the fields of CameraInfo.  vision: the scenario's section `vision` (dict).
        Returns: an object with these functions: process(image, stamp_ns) gives features; teach(stamp_ns, z_star_m)
            makes the image of this stamp, one of the last few, the reference; clear_reference() forgets it.
        """
        import aras_visual_servo_camera  # here, so that this module can be imported without C++
        extract = getattr(aras_visual_servo_camera, self.extractor_class)
        return extract(camera_info, vision[self.section] if self.section else vision)

    def read(self, message: Any, camera: Any, reference: Any) -> Any:
        """Returns the features of a message; those of our own messages are the message.

        Args: camera: of a source from elsewhere, an object with `frame_id`, "" if it is not known, and
            `normalised([(u, v)])`, which gives ((n, 2), fault).  reference: `Reference` in use, or None.
        """
        return message

    def renewed(self, extractor: Any) -> Optional[Any]:
        """This extractor, as it was before its first image; None where that cannot be had and a new one is made."""
        return None

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        """Whether `process` of the extractor also takes the depth image of the camera. Args: as of `extractor`."""
        return False

    def why_lost(self, features: Any) -> str:
        """Text that says why the arm cannot be servoed on these features; "" if it can."""
        if features.target_visible and features.valid:
            return ""
        return getattr(features, "fault", "") or (
            "features not valid" if features.target_visible else "target not in view")

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        """`Taught` for the view with these features, which need not be relative to itself.

        Args: features: fit to servo on (`why_lost` is "").  z_star_m: depth of the target in this view [m].
            normal_C: (3,) normal of its plane in the camera frame.
        """
        raise NotImplementedError

    def kept(self, features: Any) -> Any:
        """Copy of features that outlives their image."""
        return features

    def mean(self, views: Sequence[Any]) -> Any:
        """The mean of several views of one goal, for sources whose `Taught` holds a view."""
        return views[0]

    @staticmethod
    def means(views: Sequence[Any], tuples: Iterable[str], numbers: Iterable[str]) -> Dict[str, Any]:
        """The means of these fields of the views, by name, and of the depths `point_z` in those that have them all."""
        whole = [view.point_z for view in views if len(view.point_z) and np.isfinite(view.point_z).all()]
        mean = {name: np.mean([getattr(view, name) for view in views], axis=0).tolist() for name in (*tuples, *numbers)}
        depths = tuple(np.mean(whole, axis=0).tolist()) if whole else ()
        return {**mean, **{name: tuple(mean[name]) for name in tuples}, "point_z": depths}

    def follow(self, extractor: Any, features: Any) -> None:
        """Gives an extractor the reference that these recorded features had, as far as their fields tell it.

        The image that was the reference is not available then, so a source whose reference is an image forgets it.
        """
        extractor.clear_reference()
