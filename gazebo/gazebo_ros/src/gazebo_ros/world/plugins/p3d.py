"""libgazebo_ros_p3d.so: the true pose and twist of a link. The rules are those of gazebo_ros_p3d.cpp."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..devices import Device, named, number, reads, text
from ..poses import matrix_of_rpy

if typing.TYPE_CHECKING:
    from ..model import Model

WORLD = ("/world", "world", "/map", "map")  #: names of the frame that is none of the model


@dataclasses.dataclass(frozen=True)
class Pose3d(Device):
    """Where a link is, in the world or in another link of the model."""
    link: str
    topic: str
    frame: str
    rate_hz: float
    noise: float              #: standard deviation of the twist [m/s, rad/s]
    offset: numpy.ndarray     #: (4, 4): its position is added, its rotation comes before that of the link

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)

    def measured(self, model: "Model") -> typing.Tuple[numpy.ndarray, numpy.ndarray]:
        """Returns the pose (4, 4) and the twist (6,), [v; w] in the axes of the world or, as the plugin has it, turned
        by those of the frame's link."""
        pose, twist = model.link_pose(self.link).copy(), model.link_twist(self.link)
        frame = self.frame.lstrip("/")
        if self.frame not in WORLD and frame in model.links:
            X_WF = model.link_pose(frame)
            pose = numpy.linalg.inv(X_WF) @ pose
            twist = numpy.concatenate([X_WF[:3, :3].T @ part for part in
                                       (twist - model.link_twist(frame)).reshape(2, 3)])
        pose[:3, :3] = self.offset[:3, :3] @ pose[:3, :3]
        pose[:3, 3] += self.offset[:3, 3]
        return pose, twist


def triple(plugin: ElementTree.Element, *keys: str) -> typing.Tuple[float, ...]:
    """Three numbers of the first of these keys that is there, else zeros. Raises: ValueError."""
    words = next((text(plugin, key) for key in keys if text(plugin, key)), "0 0 0").split()
    if len(words) != 3:
        raise ValueError("<%s>: found %s, allowed are three numbers" % (keys[0], " ".join(words)))
    return tuple(map(float, words))


@reads("libgazebo_ros_p3d.so")
def pose_3d(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
            namespace: str) -> Pose3d:
    """Reads the tag."""
    return Pose3d(link=text(plugin, "bodyName"), topic=named(namespace, text(plugin, "topicName", "odom")),
                  frame=text(plugin, "frameName", "world"), rate_hz=number(plugin, "updateRate", 0.0),
                  noise=number(plugin, "gaussianNoise", 0.0),
                  offset=matrix_of_rpy(triple(plugin, "xyzOffset", "xyzOffsets"),
                                       triple(plugin, "rpyOffset", "rpyOffsets")))
