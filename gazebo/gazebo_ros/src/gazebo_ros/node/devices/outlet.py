"""What the topics of all devices share."""
import zlib

import numpy
import rospy

from ..beat import NEVER_NS, Beat

MOST_HZ = 1000.0  #: of a device whose rate is 0, "as fast as possible": every period of Gazebo's default physics

_OUTLETS = {}


def serves(kind):
    """Decorator: the class publishes devices of this kind."""
    def note(outlet):
        _OUTLETS[kind] = outlet
        return outlet
    return note


def outlet_of(device):
    """Class that publishes a device."""
    return _OUTLETS[type(device)]


class Outlet:
    """Topics of one device. Everything but the callbacks of rospy runs in the world's thread.

    Attributes:
        world: World.  model: Model.  device: as described.  work: Work.
    """

    def __init__(self, world, model, device, work):
        self.world, self.model, self.device, self.work = world, model, device, work
        self._ends = []
        self._beat = Beat(device.rate_hz if device.rate_hz > 0.0 else MOST_HZ, world.time_ns)
        self.open()

    @property
    def simulation(self):
        return self.model.simulation

    def advertise(self, name, kind, **options):
        publisher = rospy.Publisher(name, kind, queue_size=10, **options)
        self._ends.append(publisher.unregister)
        return publisher

    def listen(self, name, kind, react):
        subscriber = rospy.Subscriber(name, kind, lambda message: self.work.post(lambda: react(message)))
        self._ends.append(subscriber.unregister)

    def ends_with(self, action):
        self._ends.append(action)

    # --- what a kind of device does of its own

    def open(self):
        """Makes its topics."""

    def wanted(self):
        """Whether anything is to be done now."""
        return True

    def send(self, now_ns):
        """Called when it is due and wanted."""

    # --- time

    @property
    def next_ns(self):
        return self._beat.next_ns if self.wanted() else NEVER_NS

    def publish(self, now_ns):
        if self._beat.due(now_ns) and self.wanted():
            self.send(now_ns)

    def time_reset(self, now_ns):
        self._beat = Beat(self.device.rate_hz if self.device.rate_hz > 0.0 else MOST_HZ, now_ns)

    def close(self):
        for end in reversed(self._ends):
            end()
        self._ends = []


class Noise:
    """Gaussian numbers that are the same in every run: the seeds are the name of the topic and the time."""

    def __init__(self, topic, deviation):
        self._deviation, self._topic = deviation, zlib.crc32(topic.encode())

    def __call__(self, values, now_ns):
        """The values of a time with noise."""
        values = numpy.asarray(values, float)
        if self._deviation <= 0.0:
            return values
        return values + numpy.random.default_rng((self._topic, now_ns)).normal(0.0, self._deviation, values.shape)
