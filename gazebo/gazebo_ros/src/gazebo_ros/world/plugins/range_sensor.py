"""libgazebo_ros_range.so: the shortest of the rays of a sensor, as an ultrasonic or infrared sensor has it."""
import dataclasses
import typing

import numpy
import xml.etree.ElementTree as ElementTree

from ..devices import Laser, laser, named, number, reads, text


@dataclasses.dataclass(frozen=True)
class RangeSensor(Laser):
    """A laser whose nearest reading counts. Noise is that of the plugin."""
    infrared: bool            #: else ultrasound
    field_of_view_rad: float

    @staticmethod
    def nearest(ranges: numpy.ndarray, farthest_m: float) -> float:
        """Returns the shortest of these distances [m]; where nothing is met, the farthest."""
        return float(min(ranges.min(initial=farthest_m), farthest_m))


@reads("libgazebo_ros_range.so")
def range_sensor(plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element], link: str,
                 namespace: str) -> RangeSensor:
    """Reads the tag."""
    rays = laser(plugin, sensor, link, namespace)
    rate_hz = number(plugin, "updateRate", 0.0)
    given = dict(vars(rays), topic=named(namespace, text(plugin, "topicName", "/range")), noise_mean=0.0,
                 noise=number(plugin, "gaussianNoise", 0.0),
                 rate_hz=min(filter(None, (rate_hz, rays.rate_hz)), default=0.0))
    return RangeSensor(**given, infrared=text(plugin, "radiation", "ultrasound") != "ultrasound",
                       field_of_view_rad=number(plugin, "fov", 0.05))
