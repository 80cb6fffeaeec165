"""The services /gazebo/apply_body_wrench, apply_joint_effort and those that end them."""
import math

import gazebo_msgs.srv as srv
import numpy
import rospy

from ...world.errors import BadValueError, UnknownEntityError, unknown_as
from ...world.world import WORLD_FRAMES


class ForceServices:
    def __init__(self, world, serve, in_turn):
        """
        Args:
            serve, in_turn: of GazeboServices; the second for services that have no `success`.
        """
        self._world = world
        serve("apply_body_wrench", srv.ApplyBodyWrench, self._push_body)
        serve("apply_joint_effort", srv.ApplyJointEffort, self._push_joint)
        rospy.Service("/gazebo/clear_body_wrenches", srv.BodyRequest, in_turn(self._clear_body))
        rospy.Service("/gazebo/clear_joint_forces", srv.JointRequest, in_turn(self._clear_joint))

    def _push(self, model, what, is_joint, value, request):
        self._world.pushes.add(model.name, what, is_joint, value, request.start_time.to_nsec(),
                               request.duration.to_nsec(), self._world.period_ns, self._world.time_ns)

    def _push_body(self, request):
        with unknown_as("ApplyBodyWrench: body does not exist"):
            model, link = self._world.scoped(request.body_name)
        parts = [(v.x, v.y, v.z) for v in (request.wrench.force, request.wrench.torque, request.reference_point)]
        if not all(map(math.isfinite, sum(parts, ()))):
            raise BadValueError("ApplyBodyWrench: found a number that is not finite, allowed are finite numbers")
        force, torque, point = map(numpy.array, parts)
        torque = torque + numpy.cross(point, force)
        if request.reference_frame not in WORLD_FRAMES:
            with unknown_as("ApplyBodyWrench: reference_frame not found"):
                X_WF, _ = self._world.frame(request.reference_frame)
            force, torque = X_WF[:3, :3] @ force, X_WF[:3, :3] @ torque
            torque = torque + numpy.cross(X_WF[:3, 3] - model.centre_of_mass(link), force)
        self._push(model, link, False, (*force, *torque), request)
        return srv.ApplyBodyWrenchResponse(True, "ApplyBodyWrench: wrench applied")

    def _joint(self, name):
        joint = name.rpartition("::")[2]
        return self._world.joint_owner(joint), joint

    def _push_joint(self, request):
        with unknown_as("ApplyJointEffort: joint not found"):
            model, joint = self._joint(request.joint_name)
        if not math.isfinite(request.effort):
            raise BadValueError("ApplyJointEffort: found effort %s, allowed are finite numbers" % request.effort)
        self._push(model, joint, True, request.effort, request)
        return srv.ApplyJointEffortResponse(True, "ApplyJointEffort: effort set")

    def _clear_body(self, request):
        try:
            model, link = self._world.scoped(request.body_name)
            self._world.pushes.clear(model.name, link, False, self._world.time_ns)
        except UnknownEntityError as error:
            rospy.logerr("clear_body_wrenches: %s" % error)
        return srv.BodyRequestResponse()

    def _clear_joint(self, request):
        try:
            model, joint = self._joint(request.joint_name)
            self._world.pushes.clear(model.name, joint, True, self._world.time_ns)
        except UnknownEntityError as error:
            rospy.logerr("clear_joint_forces: %s" % error)
        return srv.JointRequestResponse()
