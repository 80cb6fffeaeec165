"""The node: one thread that steps the world, publishes, and answers calls."""
import functools
import time
import typing

import numpy
import rospy
from rosgraph_msgs.msg import Clock

from aras_visual_servo_sim import ArasError

from ..faults import told
from ..sdf.document import NoFolders
from ..sdf.world import WorldFile
from ..world import snapshot
from ..world.model import Model
from ..world.settings import WorldSettings
from ..world.world import World
from .cameras import Cameras
from .controller_manager import ControllerManager
from .convert import stamp
from .devices import outlet_of
from .services.part_services import PartServices
from .services.state_services import StateServices
from .services.world_services import WorldServices
from .notes import summed_up
from .outlet import NEVER_NS, Outlet
from .state_topics import StateTopics
from .work import Work

CLOCK_RATE_HZ = 100.0
LOCKSTEP = "/gazebo/lockstep"  #: parameter: name of a model whose images are to be answered before time goes on
PATIENCE_S = 10.0      #: wall time after which time goes on without an answer
PAUSED_BEAT_S = 0.1    #: wall time between two messages on /clock while time stands still
HELD_BEAT_S = 0.02     #: wall time between two looks for an answer
FORGOTTEN_LAG_S = 0.1  #: wall time; a world that is further behind does not catch up
UPDATE_RATE_HZ = 1000.0


class Server:
    """Attributes: world: World.  work: Work, calls for the world's thread.  paused, update_rate_hz: as set."""

    def __init__(self, settings: WorldSettings, folders: NoFolders, paused: bool = False,
                 clock_rate_hz: float = CLOCK_RATE_HZ) -> None:
        """Args: settings: WorldSettings.  folders: Folders."""
        self.world, self.work, self.paused = World(settings, folders), Work(), paused
        self.update_rate_hz = UPDATE_RATE_HZ
        self._interfaces, self._of_world = {}, []
        self._lockstep = rospy.get_param(LOCKSTEP, "")
        self._asked_s = None  #: wall time at which an image was sent that is not answered yet
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._slice_ns = round(1e9 / clock_rate_hz)
        PartServices(self)
        StateServices(self)
        self._states = StateTopics(self, WorldServices(self))
        self._pushes = PushesOutlet(self.world, None, self.work)
        self._restart_pace()

    # --- requests of the services, in the world's thread

    def spawn(self, name: str, xml: str, namespace: str, pose: numpy.ndarray, frame: str) -> None:
        """Raises: ModelError."""
        self._welcome(self.world.spawn(name, xml, namespace, pose, frame))

    def spawn_sdf(self, name: str, xml: str, namespace: str, pose: numpy.ndarray, frame: str) -> None:
        """Raises: ArasError."""
        described = rospy.get_param((namespace.rstrip("/") or "") + "/robot_description", "")
        model = self.world.spawn_sdf(name, xml, namespace, pose, frame, described)
        if model is not None:
            self._welcome(model)

    def fill(self, file: WorldFile) -> None:
        """Adds the content of a .world file to the world. Warns about failing parts. Args: file: WorldFile."""
        self.update_rate_hz = file.update_rate_hz
        warnings = [*file.warnings, *self.world.take_lights(file.lights)]
        for model, X_WM in file.models:
            try:
                self._welcome(self.world.place_sdf(model.name, model, X_WM))
            except ArasError as error:
                warnings.append("model '%s': %s" % (model.name, error))
            except Exception as error:  # whatever it is, the rest of the world comes up
                warnings.append("model '%s': %s" % (model.name, named(error)))
        self.world.before_ground = {model.name for model, _ in file.models[:file.ground_at]} & set(self.world.models)
        for warning in dict.fromkeys(warnings):
            rospy.logwarn("world: %s" % warning)
        makers = [functools.partial(outlet_of(device), self.world, None, device, self.work) for device in file.devices]
        self._of_world += self._opened("world", makers)
        self._restart_pace()

    def _welcome(self, model: Model) -> None:
        """Creates the topics and services of a new model, and warns about ignored parts."""
        name = model.name
        if model.warnings:
            rospy.logwarn("model '%s':\n  %s" % (name, "\n  ".join(summed_up(model.warnings))))
        makers = [functools.partial(Cameras, self.world, model, self.work)] if model.description.cameras else []
        if model.description.control_namespace:
            makers.append(functools.partial(ControllerManager, self.world, model, self.work))
        makers += [functools.partial(outlet_of(device), self.world, model, device, self.work)
                   for device in model.description.devices]
        self._interfaces[name] = self._opened("model '%s'" % name, makers)

    @staticmethod
    def _opened(owner: str, makers: typing.Iterable[functools.partial]) -> typing.List[Outlet]:
        """Returns the outlets of these functions. Logs an error for each that fails, and leaves it out."""
        made = []
        for make in makers:
            try:
                made.append(make())
            except Exception as error:  # of rospy: a name that ROS does not allow, a topic of another type
                rospy.logerr(told("plugin", "%s: %s" % (owner, make.func.__name__), named(error)))
        return made

    def _leave_out(self, outlet: Outlet, error: Exception) -> None:
        """Closes the topics of a failed plugin. The world continues."""
        owner = next((each for each in (self._of_world, *self._interfaces.values()) if outlet in each), None)
        if owner is None:
            raise error
        owner.remove(outlet)
        outlet.close()
        name = "world" if owner is self._of_world else "model '%s'" % outlet.model.name
        rospy.logerr(told("plugin", "%s: %s" % (name, type(outlet).__name__), named(error)))

    def delete(self, name: str) -> None:
        for interface in self._interfaces.pop(name):
            interface.close()
        self.world.delete(name)

    def pause(self, paused: bool) -> None:
        self.paused = paused
        self._restart_pace()

    def placed(self, name: str) -> None:
        """A model was placed from outside: that answers its images."""
        if name == self._lockstep:
            self._asked_s = None

    def _held(self) -> bool:
        """Returns whether time stands still until a client answers an image."""
        if self._asked_s is None:
            return False
        if time.monotonic() - self._asked_s < PATIENCE_S:
            return True
        rospy.logwarn("lockstep: found no set_model_state of model '%s' within %g s after an image: time goes on" %
                      (self._lockstep, PATIENCE_S))
        self._asked_s = None
        return False

    def set_physics(self, period_s: float, gravity_m_s2: typing.Sequence[float], update_rate_hz: float) -> None:
        """Args: update_rate_hz: steps per second of wall time at most; 0: as many as there can be. Raises: ArasError.
        """
        before = self.world.epoch_ns
        self.world.set_physics(period_s, gravity_m_s2)
        self.update_rate_hz = update_rate_hz
        if self.world.epoch_ns != before:
            self._tell_time()
        self._restart_pace()

    def restore(self, state: bytes) -> None:
        """Restores a saved state of the world. Raises: ArasError; nothing changes then."""
        before = dict(self.world.models)
        snapshot.restore(self.world, state)
        for name, model in before.items():
            if self.world.models.get(name) is not model:
                for interface in self._interfaces.pop(name):
                    interface.close()
        for name, model in self.world.models.items():
            if before.get(name) is not model:
                self._welcome(model)
            for interface in self._interfaces[name]:
                if isinstance(interface, ControllerManager):
                    interface.find_loaded()
        self._tell_time()
        self._restart_pace()

    def _tell_time(self) -> None:
        """Lets all that publishes at a rate begin anew."""
        for outlet in self._outlets():
            outlet.time_reset(self.world.time_ns)

    def reset(self, time_too: bool) -> None:
        if time_too:
            self.world.reset_simulation()
            self._tell_time()
        else:
            self.world.reset_world()
        self._restart_pace()

    def model_names(self) -> typing.List[str]:
        return self.world.names

    # --- time

    def _restart_pace(self) -> None:
        self._begun_ns, self._begun_s = self.world.time_ns, time.monotonic()

    def _ahead_s(self, time_ns: int) -> float:
        """Wall time to wait before simulated time may be this."""
        factor = self.update_rate_hz * self.world.settings.period_s
        if factor <= 0.0:
            return 0.0
        ahead_s = 1e-9 * (time_ns - self._begun_ns) / factor - (time.monotonic() - self._begun_s)
        if ahead_s < -FORGOTTEN_LAG_S:
            self._restart_pace()
        return max(0.0, ahead_s)

    def _outlets(self) -> typing.Iterator[Outlet]:
        yield self._states
        yield self._pushes
        yield from self._of_world
        for interfaces in self._interfaces.values():
            yield from interfaces

    def run(self) -> None:
        """Returns when ROS shuts down."""
        try:
            while not rospy.is_shutdown():
                self.work.run(0.0)
                if self.paused:
                    self._clock.publish(Clock(stamp(self.world.time_ns)))
                    self.work.run(PAUSED_BEAT_S)
                    continue
                if self._held():
                    self.work.run(HELD_BEAT_S)
                    self._restart_pace()
                    continue
                target_ns = self._next_stop()
                ahead_s = self._ahead_s(target_ns)
                if ahead_s > 0.0:
                    self.work.run(ahead_s)
                else:
                    self.advance(target_ns)
        finally:
            self.work.close()

    def _next_stop(self) -> int:
        """Returns the time of the next due message or clock; a whole number of periods."""
        now_ns, period_ns = self.world.time_ns, self.world.period_ns
        due_ns = min((outlet.next_ns for outlet in self._outlets()), default=NEVER_NS)
        clock_ns = (now_ns // self._slice_ns + 1) * self._slice_ns
        ticks = max(1, -(-(min(due_ns, clock_ns) - now_ns) // period_ns))
        return now_ns + ticks * period_ns

    def advance(self, target_ns: int) -> None:
        """Steps to a time and publishes the messages due there."""
        try:
            self.world.step((target_ns - self.world.time_ns) // self.world.period_ns)
        except ArasError as error:
            rospy.logerr("time stands still, /gazebo/unpause_physics lets it go on: %s" % error)
            self.pause(True)
            return
        self._clock.publish(Clock(stamp(self.world.time_ns)))
        outlets = list(self._outlets())
        images = self._take_images([outlet for outlet in outlets if isinstance(outlet, Cameras)])
        for outlet in outlets:
            try:
                if isinstance(outlet, Cameras):
                    outlet.send_images(self.world.time_ns, images)
                else:
                    outlet.publish(self.world.time_ns)
            except Exception as error:
                self._leave_out(outlet, error)
        if self._lockstep and self._sent_images():
            self._asked_s = time.monotonic()

    def _take_images(self, cameras: typing.List[Cameras]) -> typing.Dict[str, typing.Any]:
        """Renders the due images of these Cameras. Returns the result of World.take_frames."""
        wanted = [each for outlet in cameras for each in outlet.due(self.world.time_ns)]
        return self.world.core.take_frames(wanted) if wanted else {}

    def _sent_images(self) -> bool:
        """Whether an image of the model of the lockstep went out at this time."""
        return any(isinstance(each, Cameras) and each.sent_ns == self.world.time_ns
                   for each in self._interfaces.get(self._lockstep, ()))


def named(error: Exception) -> str:
    """An exception by its kind and text."""
    return "%s: %s" % (type(error).__name__, error)


class PushesOutlet(Outlet):
    """Lets forces from outside begin and end when they are due."""

    @property
    def next_ns(self) -> int:
        return self.world.pushes.next_ns

    def publish(self, now_ns: int) -> None:
        if self.next_ns <= now_ns:
            self.world.pushes.act(now_ns)
