"""The services /gazebo/... of one link: its state and its mass."""
import math

import gazebo_msgs.srv as srv
import numpy
from gazebo_msgs.msg import LinkState
from geometry_msgs.msg import Point, Pose, Quaternion

from ...urdf.properties import LinkProperties
from ...world.errors import BadValueError, GazeboError, unknown_as
from ...world.poses import rotated
from ...world.world import WORLD_FRAMES
from ..convert import pose_message, pose_of, twist_message, twist_of


class LinkServices:
    def __init__(self, world, serve):
        """
        Args:
            serve: of GazeboServices.
        """
        self._world = world
        serve("get_link_state", srv.GetLinkState, self._state)
        serve("set_link_state", srv.SetLinkState, self._place)
        serve("get_link_properties", srv.GetLinkProperties, self._properties)
        serve("set_link_properties", srv.SetLinkProperties, self._set)

    def _link(self, name, answer):
        with unknown_as(answer):
            return self._world.scoped(name)

    def _frame(self, name, answer):
        with unknown_as(answer):
            return self._world.frame(name)

    def _state(self, request):
        model, link = self._link(request.link_name, "GetLinkState: link not found, did you forget to scope the link by "
                                 "model name?")
        X_WF, _ = self._frame(request.reference_frame, "GetLinkState: reference reference_frame not found, did you "
                              "forget to scope the link by model name?")
        X_FW = numpy.linalg.inv(X_WF)
        frame = "world" if request.reference_frame in WORLD_FRAMES else request.reference_frame
        state = LinkState(request.link_name, pose_message(X_FW @ model.link_pose(link)),
                          twist_message(rotated(X_FW, model.link_twist(link))), frame)
        return srv.GetLinkStateResponse(state, True, "GetLinkState: got state")

    def _place(self, request):
        """A root link is placed with all that it carries; the others cannot leave their joints."""
        state = request.link_state
        model, link = self._link(state.link_name, "SetLinkState: link does not exist")
        if link != model.root:
            raise GazeboError("SetLinkState: found link '%s', which joints hold, allowed is the root link '%s' (joints "
                              "are placed by set_model_configuration)" % (link, model.root))
        X_WF, _ = self._frame(state.reference_frame, "SetLinkState: failed")
        model.place(X_WF @ pose_of(state.pose, "SetLinkState: pose"),
                    rotated(X_WF, numpy.asarray(twist_of(state.twist))))
        return srv.SetLinkStateResponse(True, "SetLinkState: success")

    def _properties(self, request):
        model, link = self._link(request.link_name, "GetLinkProperties: link not found, did you forget to scope the "
                                 "link by model name?")
        mass = model.mass_of(link)
        return srv.GetLinkPropertiesResponse(
            com=Pose(Point(*mass.com_m), Quaternion(0.0, 0.0, 0.0, 1.0)), gravity_mode=model.gravity_acts_on(link),
            mass=mass.mass_kg, **dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), mass.inertia_kg_m2)),
            success=True, status_message="GetLinkProperties: got properties")

    def _set(self, request):
        model, link = self._link(request.link_name, "SetLinkProperties: link not found, did you forget to scope the "
                                 "link by model name?")
        com = request.com.position
        properties = LinkProperties(
            mass_kg=request.mass, com_m=(com.x, com.y, com.z), gravity=request.gravity_mode,
            inertia_kg_m2=(request.ixx, request.ixy, request.ixz, request.iyy, request.iyz, request.izz))
        if not all(map(math.isfinite, (properties.mass_kg, *properties.com_m, *properties.inertia_kg_m2))):
            raise BadValueError("SetLinkProperties: found a number that is not finite, allowed are finite numbers")
        self._world.change_link(model.name, link, properties)
        return srv.SetLinkPropertiesResponse(True, "SetLinkProperties: properties set")
