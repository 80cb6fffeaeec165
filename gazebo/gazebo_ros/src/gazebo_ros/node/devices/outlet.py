"""What the topics of all devices share."""
import zlib

import numpy

from ..outlet import Outlet

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


class DeviceOutlet(Outlet):
    """Topics of one device. Attributes: device: as described."""

    def __init__(self, world, model, device, work):
        self.device, self.rate_hz = device, device.rate_hz if device.rate_hz > 0.0 else MOST_HZ
        super().__init__(world, model, work)
        self.begin(world.time_ns)


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
