"""Joints of a URDF and their positions. No ROS."""
import dataclasses
import math
import typing
import xml.etree.ElementTree as ElementTree

MOVING = ("revolute", "continuous", "prismatic")


@dataclasses.dataclass
class Mimic:
    """A joint that follows another: position = factor * position of the parent + offset."""
    parent: str
    factor: float = 1.0
    offset: float = 0.0


@dataclasses.dataclass
class Joint:
    """State of a joint that nothing follows; None: not known."""
    position: float
    velocity: float = None
    effort: float = None


class Joints:
    """All moving joints of a robot, in the order of the URDF.

    Args:
        urdf: a URDF document.
        zeros: dict of name -> position to begin with [m or rad]; else 0, or the middle of limits that exclude 0.
        dependent: dict of name -> {parent, factor, offset}, as the parameter dependent_joints.
        use_mimic: whether <mimic> counts.  use_smallest: whether <safety_controller> narrows the limits.
    """

    def __init__(self, urdf: str, zeros: typing.Optional[typing.Dict[str, float]] = None,
                 dependent: typing.Optional[typing.Dict[str, typing.Dict[str, typing.Any]]] = None,
                 use_mimic: bool = True, use_smallest: bool = True) -> None:
        zeros, self.free, self.following = zeros or {}, {}, {}
        self.names = []
        for element in ElementTree.fromstring(urdf).findall("joint"):
            if element.get("type") not in MOVING:
                continue
            name, mimic = element.get("name"), element.find("mimic")
            self.names.append(name)
            if dependent and name in dependent:
                entry = dependent[name]
                self.following[name] = Mimic(entry["parent"], entry.get("factor", 1.0), entry.get("offset", 0.0))
            elif use_mimic and mimic is not None:
                self.following[name] = Mimic(mimic.get("joint"), float(mimic.get("multiplier", 1.0)),
                                             float(mimic.get("offset", 0.0)))
            else:
                self.free[name] = Joint(zeros.get(name, beginning(element, use_smallest)))

    def update(self, name: str, position: typing.Optional[float], velocity: typing.Optional[float],
               effort: typing.Optional[float]) -> None:
        """Takes a state of another publisher. Ignores names of other robots."""
        if name in self.free:
            self.free[name] = Joint(position if position is not None else self.free[name].position, velocity, effort)

    def position(self, name: str) -> float:
        """[m or rad]; through joints that follow joints that follow others."""
        factor, offset = 1.0, 0.0
        for _ in range(len(self.names)):
            if name not in self.following:
                break
            mimic = self.following[name]
            factor, offset, name = factor * mimic.factor, offset + factor * mimic.offset, mimic.parent
        return factor * self.free[name].position + offset if name in self.free else offset

    def rate(self, name: str, key: str) -> typing.Optional[float]:
        """Returns velocity or effort, None if it is unknown; a follower's velocity is its leader's, scaled."""
        if name in self.following:
            leader = self.free.get(self.following[name].parent)
            value = getattr(leader, key) if leader else None
            return None if value is None or key == "effort" else value * self.following[name].factor
        return getattr(self.free[name], key)


def beginning(element: ElementTree.Element, use_smallest: bool) -> float:
    """0, or the middle of limits that exclude it."""
    limit, safety = element.find("limit"), element.find("safety_controller")
    if element.get("type") == "continuous" or limit is None:
        return 0.0
    lower, upper = float(limit.get("lower", -math.inf)), float(limit.get("upper", math.inf))
    if use_smallest and safety is not None:
        lower = max(lower, float(safety.get("soft_lower_limit", lower)))
        upper = min(upper, float(safety.get("soft_upper_limit", upper)))
    return 0.0 if lower <= 0.0 <= upper else 0.5 * (lower + upper)
