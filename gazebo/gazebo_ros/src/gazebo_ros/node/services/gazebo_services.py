"""The services /gazebo/...: what makes sense here is done as Gazebo does it, the rest is refused with a reason."""
import math

import gazebo_msgs.srv as srv
import numpy
import rospy
import std_srvs.srv
from gazebo_msgs.msg import ODEPhysics
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA

from aras_visual_servo_sim import ArasError

from ...sdf.world import GROUND
from ...world.errors import GazeboError, unknown_as
from ...world.lights import turned
from ...world.poses import rotated
from ..convert import pose_message, pose_of, stamp, twist_message, twist_of
from .force_services import ForceServices
from .joint_services import JointServices
from .link_services import LinkServices
from .state_services import StateServices


class GazeboServices:
    def __init__(self, server):
        """
        Args:
            server: Server, which spawns, deletes, pauses and resets.
        """
        self._server, self._world = server, server.world
        for name, (kind, answer) in {
                "spawn_urdf_model": (srv.SpawnModel, self._spawn),
                "spawn_sdf_model": (srv.SpawnModel, self._spawn_sdf),
                "get_light_properties": (srv.GetLightProperties, self._light_properties),
                "set_light_properties": (srv.SetLightProperties, self._set_light),
                "delete_light": (srv.DeleteLight, self._delete_light),
                "delete_model": (srv.DeleteModel, self._delete),
                "get_model_state": (srv.GetModelState, self._model_state),
                "set_model_state": (srv.SetModelState, self._place),
                "set_model_configuration": (srv.SetModelConfiguration, self._configure),
                "get_model_properties": (srv.GetModelProperties, self._model_properties),
                "get_world_properties": (srv.GetWorldProperties, self._world_properties),
                "get_physics_properties": (srv.GetPhysicsProperties, self._physics),
                "set_physics_properties": (srv.SetPhysicsProperties, self._set_physics)}.items():
            self._serve(name, kind, answer)
        for name, action in (("pause_physics", lambda: server.pause(True)),
                             ("unpause_physics", lambda: server.pause(False)),
                             ("reset_world", lambda: server.reset(False)),
                             ("reset_simulation", lambda: server.reset(True))):
            rospy.Service("/gazebo/" + name, std_srvs.srv.Empty, self._in_turn(
                lambda _, action=action: action() or std_srvs.srv.EmptyResponse()))
        ForceServices(self._world, self._serve, self._in_turn)
        LinkServices(self._world, self._serve)
        JointServices(self._world, self._serve)
        StateServices(server, self._in_turn)

    def _in_turn(self, answer):
        return lambda request: self._server.work.call(lambda: answer(request))

    def _serve(self, name, kind, answer):
        """Errors of the world become success: false with their text."""
        def checked(request):
            try:
                return answer(request)
            except (GazeboError, ArasError) as error:
                rospy.logerr("%s: %s" % (name, error))
                return kind._response_class(success=False, status_message=str(error))
        rospy.Service("/gazebo/" + name, kind, self._in_turn(checked))

    # --- models

    def _spawn(self, request):
        pose = pose_of(request.initial_pose, "SpawnModel: initial_pose")
        self._server.spawn(request.model_name, request.model_xml, request.robot_namespace, pose,
                           request.reference_frame)
        return srv.SpawnModelResponse(True, "SpawnModel: Successfully spawned entity")

    def _delete(self, request):
        if request.model_name == GROUND:
            self._world.remove_ground()
            return srv.DeleteModelResponse(True, "DeleteModel: successfully deleted model")
        self._known(request.model_name, "DeleteModel: model does not exist")
        self._server.delete(request.model_name)
        return srv.DeleteModelResponse(True, "DeleteModel: successfully deleted model")

    def _known(self, name, answer):
        """The model of a name. Raises: UnknownEntityError with Gazebo's own words."""
        with unknown_as(answer):
            return self._world.model(name)

    def _frame(self, name, answer):
        with unknown_as(answer):
            return self._world.frame(name)

    def _model_state(self, request):
        ground = request.model_name == GROUND and self._world.settings.ground
        model = None if ground else self._known(request.model_name, "GetModelState: model does not exist")
        X_WF, _ = self._frame(request.relative_entity_name, "GetModelState: reference relative_entity_name not found, "
                              "did you forget to scope the body by model name?")
        X_WM, twist = (numpy.eye(4), numpy.zeros(6)) if ground else (model.pose(), model.twist())
        response = srv.GetModelStateResponse(success=True, status_message="GetModelState: got properties")
        response.header.stamp, response.header.frame_id = stamp(self._world.time_ns), request.relative_entity_name
        response.pose = pose_message(numpy.linalg.inv(X_WF) @ X_WM)
        response.twist = twist_message(rotated(numpy.linalg.inv(X_WF), twist))
        return response

    def _place(self, request):
        self.place(request.model_state)
        return srv.SetModelStateResponse(True, "SetModelState: set model state done")

    def place(self, state):
        """What the topic set_model_state does too. Raises: GazeboError."""
        model = self._known(state.model_name, "SetModelState: model does not exist")
        X_WF, _ = self._frame(state.reference_frame, "SetModelState: specified reference frame entity does not exist")
        pose = X_WF @ pose_of(state.pose, "SetModelState: pose")
        model.place(pose, rotated(X_WF, numpy.asarray(twist_of(state.twist))))
        self._server.placed(state.model_name)

    def _configure(self, request):
        model = self._known(request.model_name, "SetModelConfiguration: model does not exist")
        if len(request.joint_names) != len(request.joint_positions):
            raise GazeboError("SetModelConfiguration: joint name and position list have different lengths")
        model.set_joints(dict(zip(request.joint_names, request.joint_positions)))
        return srv.SetModelConfigurationResponse(True, "SetModelConfiguration: success")

    def _model_properties(self, request):
        model = self._known(request.model_name, "GetModelProperties: model does not exist")
        return srv.GetModelPropertiesResponse(
            canonical_body_name=model.root, body_names=model.links, joint_names=model.simulation.joint_names,
            is_static=model.description.fixed, success=True, status_message="GetModelProperties: got properties")

    # --- lights

    def _spawn_sdf(self, request):
        self._server.spawn_sdf(request.model_name, request.model_xml, request.robot_namespace,
                               pose_of(request.initial_pose, "SpawnModel: initial_pose"), request.reference_frame)
        return srv.SpawnModelResponse(True, "SpawnModel: Successfully spawned entity")

    def _light_properties(self, request):
        light = self._world.lights.entry(request.light_name)
        return srv.GetLightPropertiesResponse(
            diffuse=ColorRGBA(*(light.get("intensity", 1.0) * part / 255.0 for part in light["color_rgb"]), 1.0),
            attenuation_constant=light.get("attenuation_constant", 1.0),
            attenuation_linear=light.get("attenuation_linear", 0.0),
            attenuation_quadratic=light.get("attenuation_quadratic", 0.0),
            success=True, status_message="GetLightProperties: got properties")

    def _set_light(self, request):
        """A direction of zeros, and an orientation of zeros, are none: then the light stays as it is."""
        light = self._world.lights.entry(request.light_name)
        brightest = max(1.0, *(getattr(color, part) for color in (request.diffuse, request.specular) for part in "rgb"))
        light.update(intensity=brightest, casts_shadows=request.cast_shadows)
        for key, color in (("color_rgb", request.diffuse), ("specular_rgb", request.specular)):
            light[key] = [255.0 / brightest * getattr(color, part) for part in "rgb"]
        if light["type"] != "directional":
            light.update(attenuation_constant=max(1e-9, request.attenuation_constant),
                         attenuation_linear=request.attenuation_linear,
                         attenuation_quadratic=request.attenuation_quadratic)
        pose = pose_of(request.pose, "SetLightProperties: pose")
        orientation = request.pose.orientation
        placed = any((orientation.x, orientation.y, orientation.z, orientation.w))
        direction = (request.direction.x, request.direction.y, request.direction.z)
        if placed and light["type"] != "directional":
            light["position_m"] = [float(part) for part in pose[:3, 3]]
        if any(direction) and light["type"] != "point":
            light["direction"] = turned(direction, pose[:3, :3])
        self._world.set_light(light)
        return srv.SetLightPropertiesResponse(True, "SetLightProperties: light successfully modified")

    def _delete_light(self, request):
        self._world.delete_light(request.light_name)
        return srv.DeleteLightResponse(True, "DeleteLight: light successfully deleted")

    # --- the world

    def _world_properties(self, _request):
        return srv.GetWorldPropertiesResponse(
            sim_time=1e-9 * self._world.time_ns, model_names=self._server.model_names(), rendering_enabled=True,
            success=True, status_message="GetWorldProperties: got properties")

    def _physics(self, _request):
        settings = self._world.settings
        return srv.GetPhysicsPropertiesResponse(
            time_step=settings.period_s, pause=self._server.paused, max_update_rate=self._server.update_rate_hz,
            gravity=Vector3(*settings.gravity_m_s2), ode_config=ODEPhysics(), success=True,
            status_message="GetPhysicsProperties: got properties")

    def _set_physics(self, request):
        gravity = (request.gravity.x, request.gravity.y, request.gravity.z)
        if not all(map(math.isfinite, (*gravity, request.max_update_rate, request.time_step))):
            raise GazeboError("set_physics_properties: found a number that is not finite, allowed are finite numbers")
        self._server.set_physics(request.time_step, gravity, request.max_update_rate)
        return srv.SetPhysicsPropertiesResponse(True, "physics engine updated")
