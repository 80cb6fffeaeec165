"""Devices that hold bodies: vacuum grippers, grasp fix, and the services that attach links."""
import typing

import rospy
from gazebo_ros_link_attacher.srv import Attach, AttachResponse
from std_msgs.msg import Bool
from std_srvs.srv import Empty, EmptyResponse

from aras_visual_servo_sim import ArasError

from ...world.plugins.grasp_fix import Grasp, GraspFix
from ...world.plugins.link_attacher import LinkAttacher
from ...world.plugins.vacuum_gripper import Suction, VacuumGripper
from .outlet import DeviceOutlet, serves


@serves(VacuumGripper)
class VacuumGripperOutlet(DeviceOutlet):
    def open(self) -> None:
        self._suction = Suction(self.device, self.world, self.model)
        self._grasping = self.advertise(self.device.topic, Bool)
        for name, on in zip(self.device.services, (True, False)):
            self.serve(name, Empty, lambda _, on=on: self._switch(on))

    def _switch(self, on: bool) -> EmptyResponse:
        self.work.call(lambda: self._suction.switch(on))
        return EmptyResponse()

    def wanted(self) -> bool:
        return self._suction.on or super().wanted()

    def send(self, now_ns: int) -> None:
        self._grasping.publish(Bool(self._suction.update()))


@serves(GraspFix)
class GraspFixOutlet(DeviceOutlet):
    def open(self) -> None:
        self._grasp = Grasp(self.device, self.world, self.model)

    def wanted(self) -> bool:
        return True

    def send(self, now_ns: int) -> None:
        self._grasp.update()

    def time_reset(self, now_ns: int) -> None:
        self._grasp = Grasp(self.device, self.world, self.model)
        super().time_reset(now_ns)


@serves(LinkAttacher)
class LinkAttacherOutlet(DeviceOutlet):
    """The services attach and detach."""

    def open(self) -> None:
        self._known = set()
        for name, act in (("attach", self._attach), ("detach", self._detach)):
            self.serve("%s/%s" % (self.device.namespace, name), Attach,
                       lambda request, act=act: self._answer(act, request))

    def _answer(self, act: typing.Callable[[str, str], bool], request: typing.Any) -> AttachResponse:
        one = "%s::%s" % (request.model_name_1, request.link_name_1)
        other = "%s::%s" % (request.model_name_2, request.link_name_2)

        def done() -> AttachResponse:
            try:
                return AttachResponse(ok=act(one, other))
            except ArasError as error:
                rospy.logerr("link_attacher: %s" % error)
                return AttachResponse(ok=False)
        return self.work.call(done)

    def _attach(self, one: str, other: str) -> bool:
        if self.world.is_attached(one, other):  # anew, where they are now
            self.world.detach(one, other)
        self.world.attach(one, other)
        self._known.add((one, other))
        return True

    def _detach(self, one: str, other: str) -> bool:
        if self.world.is_attached(one, other):
            self.world.detach(one, other)
            return True
        return (one, other) in self._known
