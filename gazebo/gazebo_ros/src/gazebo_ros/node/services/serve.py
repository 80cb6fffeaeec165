"""How the services under /gazebo are served."""
import math
import traceback
import typing

import rospy

from aras_visual_servo_sim import ArasError, ParameterError, UnknownNameError

from ..convert import stamp

if typing.TYPE_CHECKING:
    from ..server import Server

#: Answers a request with fields of the response, or None.
Answer = typing.Callable[[typing.Any], typing.Optional[typing.Dict[str, typing.Any]]]


class Services:
    """Services that the world's thread answers, one call after the other.

    Args: server: Server, which spawns, deletes, pauses and resets.
    """

    def __init__(self, server: "Server") -> None:
        self.server, self.world = server, server.world
        self.offer()

    def offer(self) -> None:
        """Base class of services. Subclasses define the answers."""

    def serve(self, name: str, kind: typing.Any, answer: Answer, done: str = "") -> None:
        """Serves /gazebo/NAME. answer(request) returns the response's fields, or None for no more than success: true
        with the text `done`. A rejected request returns success: false with the reason."""
        text = next((field for field in ("status_message", "message") if field in kind._response_class.__slots__), None)

        def response(success: bool, message: str, fields: typing.Dict[str, typing.Any]) -> typing.Any:
            return kind._response_class(**({"success": success, text: message, **fields} if text else fields))

        def respond(request: typing.Any) -> typing.Any:
            try:
                made = response(True, done, answer(request) or {})
            except (ArasError, OSError) as error:
                rospy.logerr("%s: %s" % (name, error))
                made = response(False, str(error), {})
            except Exception as error:  # the caller gets the error, and the world goes on
                rospy.logerr("%s: %s" % (name, traceback.format_exc()))
                made = response(False, "%s: unexpected error: %s: %s" %
                                (name, type(error).__name__, error), {})
            if hasattr(made, "stamp"):
                made.stamp = stamp(self.world.time_ns)
            return made
        rospy.Service("/gazebo/" + name, kind, lambda request: self.server.work.call(lambda: respond(request)))


def found(find: typing.Callable[[str], typing.Any], name: str, answer: str) -> typing.Any:
    """find(name). Raises: UnknownNameError with this answer, in Gazebo's own words."""
    try:
        return find(name)
    except UnknownNameError as error:
        raise UnknownNameError(answer) from error


def require_finite(what: str, *values: float) -> None:
    """Raises: ParameterError unless all are finite numbers."""
    if not all(map(math.isfinite, values)):
        raise ParameterError("%s: found a number that is not finite, allowed are finite numbers" % what)
