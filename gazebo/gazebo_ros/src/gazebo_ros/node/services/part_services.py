"""The services /gazebo/... of one link or joint: its state, properties, wrenches and efforts."""
import typing

import gazebo_msgs.srv as srv
import numpy
import rospy
from gazebo_msgs.msg import LinkState
from geometry_msgs.msg import Point, Pose, Quaternion

from aras_visual_servo_sim import ArasError, ParameterError

from ...urdf.properties import INERTIA_KEYS, LinkProperties
from ...world.model import Model
from ...world.poses import rotated
from ...world.world import WORLD_FRAMES
from ..convert import pose_message, pose_of, twist_message, twist_of
from .serve import Services, found, require_finite

#: Numbers of the ODE engine's solver, which is not there.
OF_ODE = ("erp", "cfm", "stop_erp", "stop_cfm", "fudge_factor")
SCOPE = "did you forget to scope the link by model name?"


class PartServices(Services):
    def offer(self) -> None:
        for name, kind, answer, done in (
                ("get_link_state", srv.GetLinkState, self._link_state, "GetLinkState: got state"),
                ("set_link_state", srv.SetLinkState, self._place_link, "SetLinkState: success"),
                ("get_link_properties", srv.GetLinkProperties, self._link, "GetLinkProperties: got properties"),
                ("set_link_properties", srv.SetLinkProperties, self._set_link, "SetLinkProperties: properties set"),
                ("get_joint_properties", srv.GetJointProperties, self._joint, "GetJointProperties: got properties"),
                ("set_joint_properties", srv.SetJointProperties, self._set_joint, "SetJointProperties: properties set"),
                ("apply_body_wrench", srv.ApplyBodyWrench, self._push_link, "ApplyBodyWrench: wrench applied"),
                ("apply_joint_effort", srv.ApplyJointEffort, self._push_joint, "ApplyJointEffort: effort set"),
                ("clear_body_wrenches", srv.BodyRequest, self._clear_link, ""),
                ("clear_joint_forces", srv.JointRequest, self._clear_joint, "")):
            self.serve(name, kind, answer, done)

    def _find_joint(self, name: str) -> typing.Tuple[Model, str]:
        """(model, joint) of MODEL::JOINT or JOINT."""
        joint = name.rpartition("::")[2]
        return self.world.joint_owner(joint), joint

    # --- links

    def _link_state(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        model, link = found(self.world.scoped, request.link_name, "GetLinkState: link not found, " + SCOPE)
        X_WF, _ = found(self.world.frame, request.reference_frame,
                        "GetLinkState: reference reference_frame not found, " + SCOPE)
        X_FW = numpy.linalg.inv(X_WF)
        frame = "world" if request.reference_frame in WORLD_FRAMES else request.reference_frame
        return {"link_state": LinkState(request.link_name, pose_message(X_FW @ model.link_pose(link)),
                                        twist_message(rotated(X_FW, model.link_twist(link))), frame)}

    def _place_link(self, request: typing.Any) -> None:
        """A root link is placed with all that it carries; the others cannot leave their joints."""
        state = request.link_state
        model, link = found(self.world.scoped, state.link_name, "SetLinkState: link does not exist")
        if link != model.root:
            raise ArasError("SetLinkState: found link '%s', which joints hold, allowed is the root link '%s' (joints "
                            "are placed by set_model_configuration)" % (link, model.root))
        X_WF, _ = found(self.world.frame, state.reference_frame, "SetLinkState: failed")
        model.place(X_WF @ pose_of(state.pose, "SetLinkState: pose"),
                    rotated(X_WF, numpy.asarray(twist_of(state.twist))))

    def _link(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        model, link = found(self.world.scoped, request.link_name, "GetLinkProperties: link not found, " + SCOPE)
        own = model.properties_of(link)
        return {"com": Pose(Point(*own.com_m), Quaternion(0.0, 0.0, 0.0, 1.0)), "mass": own.mass_kg,
                "gravity_mode": own.gravity, **dict(zip(INERTIA_KEYS, own.inertia_kg_m2))}

    def _set_link(self, request: typing.Any) -> None:
        model, link = found(self.world.scoped, request.link_name, "SetLinkProperties: link not found, " + SCOPE)
        com = request.com.position
        properties = LinkProperties(request.mass, (com.x, com.y, com.z),
                                    tuple(getattr(request, key) for key in INERTIA_KEYS), request.gravity_mode)
        require_finite("SetLinkProperties", properties.mass_kg, *properties.com_m, *properties.inertia_kg_m2)
        self.world.change_link(model.name, link, properties)

    def _push_link(self, request: typing.Any) -> None:
        model, link = found(self.world.scoped, request.body_name, "ApplyBodyWrench: body does not exist")
        parts = [(v.x, v.y, v.z) for v in (request.wrench.force, request.wrench.torque, request.reference_point)]
        require_finite("ApplyBodyWrench", *sum(parts, ()))
        force, torque, point = map(numpy.array, parts)
        torque = torque + numpy.cross(point, force)
        if request.reference_frame not in WORLD_FRAMES:
            X_WF, _ = found(self.world.frame, request.reference_frame, "ApplyBodyWrench: reference_frame not found")
            force, torque = X_WF[:3, :3] @ force, X_WF[:3, :3] @ torque
            torque = torque + numpy.cross(X_WF[:3, 3] - model.centre_of_mass(link), force)
        self._push(model, link, False, (*force, *torque), request)

    def _clear_link(self, request: typing.Any) -> None:
        model, link = self.world.scoped(request.body_name)
        self.world.pushes.clear(model.name, link, False, self.world.time_ns)

    # --- joints

    def _joint(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        model, joint = found(self._find_joint, request.joint_name, "GetJointProperties: joint not found")
        simulation = model.simulation
        k = simulation.joint_names.index(joint)
        return {"type": model.description.joint_types.get(joint, 0), "damping": [model.damping_of(joint)],
                "position": [simulation.joint_positions[k]], "rate": [simulation.joint_velocities[k]]}

    def _set_joint(self, request: typing.Any) -> None:
        """A motor of ODE (fmax, vel) that holds a joint still with at most a force is Coulomb's friction."""
        model, joint = found(self._find_joint, request.joint_name, "SetJointProperties: joint not found")
        config = request.ode_joint_config
        for key in config.__slots__:
            require_finite("SetJointProperties: " + key, *getattr(config, key))
        if any(config.vel):
            raise ParameterError("SetJointProperties: vel: found %g, allowed is 0: a controller moves a joint" %
                                 config.vel[0])
        without = [key for key in OF_ODE if getattr(config, key)]
        if without:
            rospy.logwarn("set_joint_properties: %s: there is no ODE whose numbers these are: no effect" %
                          ", ".join(without))
        said = {"damping": config.damping, "friction": config.fmax, "lower": config.loStop, "upper": config.hiStop}
        self.world.change_joint(model.name, joint, {key: values[0] for key, values in said.items() if values})

    def _push_joint(self, request: typing.Any) -> None:
        model, joint = found(self._find_joint, request.joint_name, "ApplyJointEffort: joint not found")
        require_finite("ApplyJointEffort: effort", request.effort)
        self._push(model, joint, True, request.effort, request)

    def _clear_joint(self, request: typing.Any) -> None:
        model, joint = self._find_joint(request.joint_name)
        self.world.pushes.clear(model.name, joint, True, self.world.time_ns)

    def _push(self, model: Model, what: str, is_joint: bool, value: typing.Any, request: typing.Any) -> None:
        self.world.pushes.add(model.name, what, is_joint, value, request.start_time.to_nsec(),
                              request.duration.to_nsec(), self.world.period_ns, self.world.time_ns)
