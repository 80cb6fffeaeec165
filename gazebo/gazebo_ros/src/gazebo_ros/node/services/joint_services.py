"""The services /gazebo/... of one joint: its state, damping and limits."""
import math

import gazebo_msgs.srv as srv
import rospy

from ...urdf.properties import JointProperties
from ...world.errors import BadValueError, unknown_as

#: Numbers of the ODE engine's solver, which is not there.
OF_ODE = ("erp", "cfm", "stop_erp", "stop_cfm", "fudge_factor")


class JointServices:
    def __init__(self, world, serve):
        """
        Args:
            serve: of GazeboServices.
        """
        self._world = world
        serve("get_joint_properties", srv.GetJointProperties, self._properties)
        serve("set_joint_properties", srv.SetJointProperties, self._set)

    def _joint(self, name, answer):
        joint = name.rpartition("::")[2]
        with unknown_as(answer):
            return self._world.joint_owner(joint), joint

    def _properties(self, request):
        model, joint = self._joint(request.joint_name, "GetJointProperties: joint not found")
        simulation = model.simulation
        k = simulation.joint_names.index(joint)
        return srv.GetJointPropertiesResponse(
            type=model.description.joint_types.get(joint, 0), damping=[model.damping_of(joint)],
            position=[simulation.joint_positions[k]], rate=[simulation.joint_velocities[k]], success=True,
            status_message="GetJointProperties: got properties")

    def _set(self, request):
        """A motor of ODE (fmax, vel) that holds a joint still with at most a force is Coulomb's friction."""
        model, joint = self._joint(request.joint_name, "SetJointProperties: joint not found")
        config = request.ode_joint_config
        for key in config.__slots__:
            if not all(map(math.isfinite, getattr(config, key))):
                raise BadValueError("SetJointProperties: %s: found a number that is not finite, allowed are finite "
                                    "numbers" % key)
        if any(config.vel):
            raise BadValueError("SetJointProperties: vel: found %g, allowed is 0: a controller moves a joint" %
                                config.vel[0])
        without = [key for key in OF_ODE if getattr(config, key)]
        if without:
            rospy.logwarn("set_joint_properties: %s: there is no ODE whose numbers these are: no effect" %
                          ", ".join(without))
        self._world.change_joint(model.name, joint, JointProperties(
            damping=first(config.damping), friction=first(config.fmax), lower=first(config.loStop),
            upper=first(config.hiStop)))
        return srv.SetJointPropertiesResponse(True, "SetJointProperties: properties set")


def first(values):
    """Of the joint's one axis, None if nothing is said."""
    return values[0] if values else None
