"""Lasers: sensor_msgs/LaserScan."""
import numpy
from sensor_msgs.msg import LaserScan

from ...world.devices import Laser
from ...world.rays import directions_of, resampled
from ..convert import stamp
from .outlet import Noise, Outlet, serves


@serves(Laser)
class LaserOutlet(Outlet):
    """Distances from where the sensor is at the stamp; infinite where nothing is within the range."""

    def open(self):
        device = self.device
        self._directions = directions_of(device.horizontal, device.vertical)
        self._noise = Noise(device.topic, device.noise)
        self._messages = self.advertise(device.topic, LaserScan)

    def wanted(self):
        return self._messages.get_num_connections() > 0

    def send(self, now_ns):
        device, turns = self.device, self.device.horizontal
        ranges, retros = scan(self.world, self.model, device, self._directions)
        message = LaserScan(angle_min=turns.lowest, angle_max=turns.highest, range_min=device.range_min_m,
                            range_max=device.range_max_m)
        message.angle_increment = (turns.highest - turns.lowest) / max(1, turns.count - 1)
        message.header.stamp, message.header.frame_id = stamp(now_ns), device.frame
        noisy = self._noise(ranges + device.noise_mean, now_ns)
        seen = numpy.isfinite(ranges)
        ranges[seen] = numpy.clip(noisy[seen], device.range_min_m, device.range_max_m)
        message.ranges, message.intensities = ranges.tolist(), retros.tolist()
        self._messages.publish(message)


def scan(world, model, device, directions):
    """What a laser measures now, without noise: ranges, infinite where there is nothing, and intensities."""
    ranges, retros = world.cast_rays(model.link_pose(device.link) @ device.X_LS, directions, device.range_min_m,
                                     device.range_max_m, device.sees_visuals)
    ranges = resampled(numpy.minimum(ranges, device.range_max_m), device.horizontal, device.vertical)
    ranges[ranges >= device.range_max_m] = numpy.inf
    return ranges, resampled(retros, device.horizontal, device.vertical)
