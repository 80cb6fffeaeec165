"""Base class of topics of the world: their place in the ROS graph, and their rates."""
import re
import typing

import rospy

from aras_visual_servo_sim import Robot

from ..faults import told
from ..world.model import Model
from ..world.pushes import NEVER_NS
from ..world.world import World
from .work import Work


class Beat:
    """Due at its beginning and then every period of simulated time."""

    def __init__(self, rate_hz: float, now_ns: int) -> None:
        self._period_ns = max(1, round(1e9 / rate_hz))
        self.next_ns = now_ns

    def due(self, now_ns: int) -> bool:
        """Whether it is time. Moves on to the next time after now if so."""
        if now_ns < self.next_ns:
            return False
        self.next_ns += self._period_ns * (1 + (now_ns - self.next_ns) // self._period_ns)
        return True


#: Characters that no ROS name may have. roscpp rejects `-` too, rospy warns about it.
ILLEGAL = re.compile(r"[^A-Za-z0-9_/~-]")


class Outlet:
    """Topics of one part of the world. Everything but the callbacks of rospy runs in the world's thread.

    Attributes:
        world: World.  model: Model that it belongs to, if any.  work: Work.
        rate_hz: rate of send() while there are subscribers; 0: never.
    """

    rate_hz = 0.0

    def __init__(self, world: World, model: typing.Optional[Model], work: Work) -> None:
        self.world, self.model, self.work = world, model, work
        self._publishers: typing.List[rospy.Publisher] = []
        self._ends: typing.List[typing.Callable[[], typing.Any]] = []
        self._beat: typing.Optional[Beat] = None
        try:
            self.open()
        except Exception:
            self.close()
            raise

    @property
    def simulation(self) -> Robot:
        return self.model.simulation

    def _owner(self) -> str:
        return "model '%s'" % self.model.name if self.model is not None else "world"

    def _legal(self, name: str) -> str:
        """Returns a name without characters that ROS forbids. Warns if it changes."""
        legal = ILLEGAL.sub("_", name)
        if legal != name:
            rospy.logwarn(told("ros name", self._owner(), "the name '%s'" % name, legal))
        return legal

    def advertise(self, name: str, kind: typing.Any, queue_size: int = 10) -> rospy.Publisher:
        publisher = rospy.Publisher(self._legal(name), kind, queue_size=queue_size)
        self._publishers.append(publisher)
        self._ends.append(publisher.unregister)
        return publisher

    def listen(self, name: str, kind: typing.Any, react: typing.Callable[[typing.Any], typing.Any]) -> None:
        """Subscribes react(message), called in the world's thread. Its errors are logged."""
        self._ends.append(rospy.Subscriber(
            self._legal(name), kind, lambda message: self.work.post(lambda: react(message), name)).unregister)

    def serve(self, name: str, kind: typing.Any, respond: typing.Callable[[typing.Any], typing.Any]) -> None:
        """Serves respond(request), in a thread of rospy. A service that this node serves already stays what it is, with
        an error in the log, as roscpp has it."""
        try:
            self._ends.append(rospy.Service(self._legal(name), kind, respond).shutdown)
        except rospy.ServiceException:
            rospy.logerr(told("topic", "%s: service %s" % (self._owner(), name), "it served already"))

    def ends_with(self, action: typing.Callable[[], typing.Any]) -> None:
        """action() is called at the end."""
        self._ends.append(action)

    def close(self) -> None:
        for end in reversed(self._ends):
            end()
        self._ends = []

    # --- to be overridden

    def open(self) -> None:
        """Makes its topics."""

    def wanted(self) -> bool:
        """Whether send() has anything to do now."""
        return any(publisher.get_num_connections() for publisher in self._publishers)

    def send(self, now_ns: int) -> None:
        """Called when it is due and wanted."""

    # --- time

    def begin(self, now_ns: int) -> None:
        """Counts the periods of send() from now."""
        self._beat = Beat(self.rate_hz, now_ns) if self.rate_hz > 0.0 else None

    @property
    def next_ns(self) -> int:
        """When publish() wants to be called."""
        return self._beat.next_ns if self._beat is not None and self.wanted() else NEVER_NS

    def publish(self, now_ns: int) -> None:
        """Called at every stop of the world."""
        if self._beat is not None and self._beat.due(now_ns) and self.wanted():
            self.send(now_ns)

    def time_reset(self, now_ns: int) -> None:
        """Time went back."""
        self.begin(now_ns)
