"""libgazebo_ros_block_laser.so: a laser that sends points in its own axes in place of distances."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..devices import Laser, laser, number, reads


@dataclasses.dataclass(frozen=True)
class BlockLaser(Laser):
    """A laser whose rays that meet nothing end at its range. Noise is that of the plugin, of each coordinate."""

    def points(self, ranges: numpy.ndarray, directions: numpy.ndarray) -> numpy.ndarray:
        """Returns where the rays end in the axes of the sensor, (n, 3) [m].

        Args: ranges: (n,) [m], infinite where nothing is met.  directions: (n, 3), unit vectors.
        """
        return numpy.minimum(ranges, self.range_max_m)[:, None] * directions


@reads("libgazebo_ros_block_laser.so")
def block_laser(plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element], link: str,
                namespace: str) -> BlockLaser:
    """Reads the tag; as many points come as the scan has samples, whatever its resolution says."""
    given = vars(laser(plugin, sensor, link, namespace))
    scans = {key: dataclasses.replace(given[key], count=given[key].samples) for key in ("horizontal", "vertical")}
    return BlockLaser(**{**given, **scans, "noise_mean": 0.0, "noise": number(plugin, "gaussianNoise", 0.0)})
