"""The services /gazebo/... of the world, its models and lights: requests with a counterpart here act as in
Gazebo, the others are rejected with a reason."""
import typing

import gazebo_msgs.srv as srv
import numpy
from gazebo_msgs.msg import ODEPhysics
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA, Header
from std_srvs.srv import Empty

from aras_visual_servo_sim import ArasError

from ...sdf.world import GROUND
from ...world.poses import rotated
from ..convert import pose_message, pose_of, stamp, twist_message, twist_of
from .serve import Services, found, require_finite


class WorldServices(Services):
    def offer(self) -> None:
        server, spawned = self.server, "SpawnModel: Successfully spawned entity"
        for name, kind, answer, done in (
                ("spawn_urdf_model", srv.SpawnModel, lambda request: self._spawn(request, server.spawn), spawned),
                ("spawn_sdf_model", srv.SpawnModel, lambda request: self._spawn(request, server.spawn_sdf), spawned),
                ("delete_model", srv.DeleteModel, self._delete, "DeleteModel: successfully deleted model"),
                ("get_model_state", srv.GetModelState, self._model_state, "GetModelState: got properties"),
                ("set_model_state", srv.SetModelState, lambda request: self.place(request.model_state),
                 "SetModelState: set model state done"),
                ("set_model_configuration", srv.SetModelConfiguration, self._configure,
                 "SetModelConfiguration: success"),
                ("get_model_properties", srv.GetModelProperties, self._model, "GetModelProperties: got properties"),
                ("get_light_properties", srv.GetLightProperties, self._light, "GetLightProperties: got properties"),
                ("set_light_properties", srv.SetLightProperties, self._set_light,
                 "SetLightProperties: light successfully modified"),
                ("delete_light", srv.DeleteLight, lambda request: self.world.delete_light(request.light_name),
                 "DeleteLight: light successfully deleted"),
                ("get_world_properties", srv.GetWorldProperties, self._world, "GetWorldProperties: got properties"),
                ("get_physics_properties", srv.GetPhysicsProperties, self._physics,
                 "GetPhysicsProperties: got properties"),
                ("set_physics_properties", srv.SetPhysicsProperties, self._set_physics, "physics engine updated"),
                ("pause_physics", Empty, lambda _: server.pause(True), ""),
                ("unpause_physics", Empty, lambda _: server.pause(False), ""),
                ("reset_world", Empty, lambda _: server.reset(False), ""),
                ("reset_simulation", Empty, lambda _: server.reset(True), "")):
            self.serve(name, kind, answer, done)

    # --- models

    @staticmethod
    def _spawn(request: typing.Any, spawn: typing.Callable[..., None]) -> None:
        spawn(request.model_name, request.model_xml, request.robot_namespace,
              pose_of(request.initial_pose, "SpawnModel: initial_pose"), request.reference_frame)

    def _delete(self, request: typing.Any) -> None:
        if request.model_name == GROUND:
            self.world.remove_ground()
            return
        found(self.world.model, request.model_name, "DeleteModel: model does not exist")
        self.server.delete(request.model_name)

    def _model_state(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        ground = request.model_name == GROUND and self.world.settings.ground
        model = None if ground else found(self.world.model, request.model_name, "GetModelState: model does not exist")
        X_WF, _ = found(self.world.frame, request.relative_entity_name, "GetModelState: reference "
                        "relative_entity_name not found, did you forget to scope the body by model name?")
        X_WM, twist = (numpy.eye(4), numpy.zeros(6)) if ground else (model.pose(), model.twist())
        X_FW = numpy.linalg.inv(X_WF)
        header = Header(stamp=stamp(self.world.time_ns), frame_id=request.relative_entity_name)
        return {"header": header, "pose": pose_message(X_FW @ X_WM), "twist": twist_message(rotated(X_FW, twist))}

    def place(self, state: typing.Any) -> None:
        """Handles set_model_state of the service and of the topic. Raises: ArasError."""
        model = found(self.world.model, state.model_name, "SetModelState: model does not exist")
        X_WF, _ = found(self.world.frame, state.reference_frame,
                        "SetModelState: specified reference frame entity does not exist")
        pose = X_WF @ pose_of(state.pose, "SetModelState: pose")
        model.place(pose, rotated(X_WF, numpy.asarray(twist_of(state.twist))))
        self.server.placed(state.model_name)

    def _configure(self, request: typing.Any) -> None:
        model = found(self.world.model, request.model_name, "SetModelConfiguration: model does not exist")
        if len(request.joint_names) != len(request.joint_positions):
            raise ArasError("SetModelConfiguration: joint name and position list have different lengths")
        model.set_joints(dict(zip(request.joint_names, request.joint_positions)))

    def _model(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        model = found(self.world.model, request.model_name, "GetModelProperties: model does not exist")
        return {"canonical_body_name": model.root, "body_names": model.bodies,
                "joint_names": model.simulation.joint_names, "is_static": model.description.fixed}

    # --- lights

    def _light(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        light = self.world.light(request.light_name)
        return {"diffuse": ColorRGBA(*(light.get("intensity", 1.0) * part / 255.0 for part in light["color_rgb"]), 1.0),
                "attenuation_constant": light.get("attenuation_constant", 1.0),
                "attenuation_linear": light.get("attenuation_linear", 0.0),
                "attenuation_quadratic": light.get("attenuation_quadratic", 0.0)}

    def _set_light(self, request: typing.Any) -> None:
        """A direction of zeros, and an orientation of zeros, are none: then the light stays as it is."""
        light = self.world.light(request.light_name)
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
            light["position_m"] = pose[:3, 3].tolist()
        if any(direction) and light["type"] != "point":
            light["direction"] = (pose[:3, :3] @ direction).tolist()
        self.world.set_light(light)

    # --- the world

    def _world(self, _request: typing.Any) -> typing.Dict[str, typing.Any]:
        return {"sim_time": 1e-9 * self.world.time_ns, "model_names": self.server.model_names(),
                "rendering_enabled": True}

    def _physics(self, _request: typing.Any) -> typing.Dict[str, typing.Any]:
        settings = self.world.settings
        return {"time_step": settings.period_s, "pause": self.server.paused,
                "max_update_rate": self.server.update_rate_hz, "gravity": Vector3(*settings.gravity_m_s2),
                "ode_config": ODEPhysics()}

    def _set_physics(self, request: typing.Any) -> None:
        gravity = (request.gravity.x, request.gravity.y, request.gravity.z)
        require_finite("set_physics_properties", *gravity, request.max_update_rate, request.time_step)
        self.server.set_physics(request.time_step, gravity, request.max_update_rate)
