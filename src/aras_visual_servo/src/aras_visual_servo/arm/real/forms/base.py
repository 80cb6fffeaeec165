"""Forms of commands: what the driver of an arm takes, ros_control's topics among them. Each file here is one form:

    @register_form("mine")
    class Mine(Form):
        def messages(self, point): return [Message("/my_arm/command", "my_msgs/Target", {"q": list(point.position)})]

Topics and message types are plain text; this room imports nothing of ROS. The node makes the messages from the fields.
"""

from typing import Any, Dict, NamedTuple, Tuple

from ....config.plugins import load_room
from ....ground.errors import ParameterError

_FORMS = {}


class SetPoint(NamedTuple):
    """What the joints are to do from now on.

    Attributes:
        stamp_ns: ROS time [ns].  joint_names: n names.
        position: (n,) set-points for a driver that takes positions [m, rad].
        velocity: (n,) velocities for a driver that takes velocities [m/s, rad/s]; 0 at rest.
        resting: the arm is to stand still.
    """

    stamp_ns: int
    joint_names: Tuple[str, ...]
    position: Any
    velocity: Any
    resting: bool


class Message(NamedTuple):
    """One message to publish: its topic, its type "package/Type", and its fields as plain values.

    A field `header` holds the stamp [ns], a field whose name ends in `_s` of a trajectory point a duration [s].
    """

    topic: str
    kind: str
    fields: Dict[str, Any]


def register_form(name):
    """Class decorator that makes a form known by name."""

    def add(form):
        form.name = name
        _FORMS[name] = form
        return form

    return add


def known_forms():
    """Names of the registered forms, sorted."""
    load_room(__package__)
    return tuple(sorted(_FORMS))


def make_form(settings):
    """The `Form` that the settings name. Args: settings: `RealSettings`. Raises ParameterError: unknown."""
    if settings.command not in known_forms():
        raise ParameterError(f"real/command: found {settings.command}, allowed {', '.join(known_forms())}")
    return _FORMS[settings.command](settings)


class Form:
    """Base class of the forms. Args: settings: `RealSettings`."""

    name = ""

    def __init__(self, settings):
        self._settings = settings

    def messages(self, point):
        """List of `Message` for a `SetPoint`."""
        raise NotImplementedError

    def _numbers(self, joint_names, values):
        """One message for all joints if they share a controller, else one for each."""
        settings = self._settings
        if settings.controller:
            data = [float(value) for value in values]
            return [Message(f"{settings.controller}/command", "std_msgs/Float64MultiArray", {"data": data})]
        names = [settings.joint_controllers.get(name, f"{name}_controller") for name in joint_names]
        return [Message(f"{controller}/command", "std_msgs/Float64", {"data": float(value)})
                for controller, value in zip(names, values)]
