"""Topics of link poses, contacts and rays: p3d, joint states, bumpers, range sensors, lasers of points."""
import typing

import numpy
from gazebo_msgs.msg import ContactsState, ContactState
from geometry_msgs.msg import Point32, Vector3, Wrench
from nav_msgs.msg import Odometry
from sensor_msgs.msg import ChannelFloat32, JointState, PointCloud, Range

from ...world.plugins.block_laser import BlockLaser
from ...world.plugins.bumper import Bumper, collision_of
from ...world.plugins.joint_states import JointStatePublisher
from ...world.plugins.p3d import Pose3d
from ...world.plugins.range_sensor import RangeSensor
from ..convert import pose_message, stamped, twist_message
from .outlet import DeviceOutlet, Noise, serves
from .sensors import RaysOutlet, SensorOutlet


@serves(Pose3d)
class Pose3dOutlet(SensorOutlet):
    """The pose is exact; the noise is that of the twist."""

    kind = Odometry

    def measured(self, now_ns: int) -> Odometry:
        pose, twist = self.device.measured(self.model)
        message = stamped(Odometry, now_ns, self.device.frame, child_frame_id=self.device.link)
        message.pose.pose = pose_message(pose)
        message.twist.twist = twist_message(self._noise(twist, now_ns))
        for part in (message.pose, message.twist):
            part.covariance = [self.device.noise ** 2 if k % 7 == 0 else 0.0 for k in range(36)]
        return message


@serves(JointStatePublisher)
class JointStatesOutlet(DeviceOutlet):
    def open(self) -> None:
        self._messages = self.advertise(self.device.topic, JointState)

    def send(self, now_ns: int) -> None:
        names, positions, velocities = self.device.measured(self.model)
        self._messages.publish(stamped(JointState, now_ns, name=names, position=positions, velocity=velocities))


@serves(Bumper)
class BumperOutlet(DeviceOutlet):
    """Points, normals and forces are in the world, whatever frame the header names, as in Gazebo."""

    def open(self) -> None:
        self._messages = self.advertise(self.device.topic, ContactsState)

    def send(self, now_ns: int) -> None:
        message = stamped(ContactsState, now_ns, self.device.frame)
        own = collision_of("%s::%s" % (self.model.name, self.device.link))
        centre = self.model.link_pose(self.device.link)[:3, 3]
        for other, touches in self.device.touched(self.world, self.model).items():
            wrenches = [(touch.force, numpy.cross(touch.point - centre, touch.force)) for touch in touches]
            message.states.append(ContactState(
                info="", collision1_name=own, collision2_name=collision_of(other),
                wrenches=[wrench_message(*each) for each in wrenches],
                total_wrench=wrench_message(sum(each[0] for each in wrenches), sum(each[1] for each in wrenches)),
                contact_positions=[Vector3(*map(float, touch.point)) for touch in touches],
                contact_normals=[Vector3(*map(float, touch.normal)) for touch in touches],
                depths=[touch.depth_m for touch in touches]))
        self._messages.publish(message)


def wrench_message(force: typing.Sequence[float], torque: typing.Sequence[float]) -> Wrench:
    """geometry_msgs/Wrench."""
    return Wrench(Vector3(*map(float, force)), Vector3(*map(float, torque)))


@serves(RangeSensor)
class RangeOutlet(RaysOutlet):
    kind = Range

    def measured(self, now_ns: int) -> Range:
        device = self.device
        ranges, _ = self.scan()
        nearest = device.nearest(ranges, device.range_max_m)
        if nearest < device.range_max_m:
            nearest = min(float(self._noise([nearest], now_ns)[0]), device.range_max_m)
        return stamped(Range, now_ns, device.frame, radiation_type=Range.INFRARED if device.infrared else
                       Range.ULTRASOUND, field_of_view=device.field_of_view_rad, min_range=device.range_min_m,
                       max_range=device.range_max_m, range=nearest)


@serves(BlockLaser)
class BlockLaserOutlet(RaysOutlet):
    kind = PointCloud

    def open(self) -> None:
        super().open()
        self._intensities = Noise(self.device.topic + " intensities", self.device.noise)

    def measured(self, now_ns: int) -> PointCloud:
        ranges, retros = self.scan()
        points = self.device.points(ranges, self.directions)
        points = numpy.where(numpy.isfinite(ranges)[:, None], self._noise(points, now_ns), points)
        return stamped(PointCloud, now_ns, self.device.frame, points=[Point32(*map(float, p)) for p in points],
                       channels=[ChannelFloat32(values=self._intensities(retros, now_ns).tolist())])
