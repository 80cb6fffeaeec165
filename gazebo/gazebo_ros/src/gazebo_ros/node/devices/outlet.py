"""Base class of the topics of devices."""
import typing
import zlib

import numpy

from ...world.devices import Device
from ...world.model import Model
from ...world.world import World
from ..outlet import Outlet
from ..work import Work

MOST_HZ = 1000.0  #: of a device whose rate is 0, "as fast as possible": every period of Gazebo's default physics

OutletClass = typing.Type["DeviceOutlet"]
_OUTLETS: typing.Dict[typing.Type[Device], OutletClass] = {}


def serves(kind: typing.Type[Device]) -> typing.Callable[[OutletClass], OutletClass]:
    """Decorator: the class publishes devices of this kind."""
    def note(outlet: OutletClass) -> OutletClass:
        _OUTLETS[kind] = outlet
        return outlet
    return note


def outlet_of(device: Device) -> typing.Type["DeviceOutlet"]:
    """Class that publishes a device."""
    return _OUTLETS[type(device)]


class DeviceOutlet(Outlet):
    """Topics of one device. Attributes: device: as described."""

    def __init__(self, world: World, model: typing.Optional[Model], device: typing.Any, work: Work) -> None:
        self.device, self.rate_hz = device, device.rate_hz if device.rate_hz > 0.0 else MOST_HZ
        super().__init__(world, model, work)
        self.begin(world.time_ns)


class Noise:
    """Gaussian numbers that are the same in every run: the seeds are the name of the topic and the time."""

    def __init__(self, topic: str, deviation: float) -> None:
        self._deviation, self._topic = deviation, zlib.crc32(topic.encode())

    def __call__(self, values: typing.Sequence[float], now_ns: int) -> numpy.ndarray:
        """The values of a time with noise."""
        exact = numpy.asarray(values, float)
        if self._deviation <= 0.0:
            return exact
        return exact + numpy.random.default_rng((self._topic, now_ns)).normal(0.0, self._deviation, exact.shape)
