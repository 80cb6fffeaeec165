"""ros_control's controller manager of one model: its services, and the topics of the controllers that are loaded."""
import typing

import rospy
from controller_manager_msgs.msg import ControllerState, HardwareInterfaceResources
from controller_manager_msgs.srv import (ListControllers, ListControllerTypes, LoadController,
                                         ReloadControllerLibraries, SwitchController, SwitchControllerRequest,
                                         UnloadController)

from aras_visual_servo_sim import ArasError

from ..controllers import ADAPTERS, Adapter
from ..world.devices import joined
from .outlet import NEVER_NS, Outlet

BASE_CLASS = "controller_interface::ControllerBase"


class ControllerManager(Outlet):
    """Answers as controller_manager does: a failed request returns false and logs an error."""

    def open(self) -> None:
        self._space = self.model.description.control_namespace
        self._adapters, self._types_asked = {}, {}
        for name, kind, answer in (("load_controller", LoadController, self._load),
                                   ("unload_controller", UnloadController, self._unload),
                                   ("switch_controller", SwitchController, self._switch),
                                   ("list_controllers", ListControllers, self._list),
                                   ("list_controller_types", ListControllerTypes, self._types),
                                   ("reload_controller_libraries", ReloadControllerLibraries, self._reload)):
            self._serve(name, kind, answer)

    def _serve(self, name: str, kind: typing.Any,
               answer: typing.Callable[[typing.Any], typing.Tuple[typing.Any, ...]]) -> None:
        """Serves answer(request), which returns the response's fields. A rejected request returns false."""
        def respond(request: typing.Any) -> typing.Any:
            try:
                return kind._response_class(*answer(request))
            except ArasError as error:
                self._tell(str(error))
                return kind._response_class(False)
        self.serve(joined(self._space, "controller_manager", name), kind,
                   lambda request: self.work.call(lambda: respond(request)))

    def _loaded(self) -> typing.List[typing.Dict[str, typing.Any]]:
        """Those of ros_control: wheels that a plugin drives are not among them."""
        return [each for each in self.simulation.loaded_controllers() if each["name"] in self._adapters]

    def _tell(self, text: str) -> None:
        rospy.logerr("%s: %s" % (joined(self._space, "controller_manager"), text))

    # --- services

    def _load(self, request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        try:
            asked = rospy.get_param(joined(self._space, request.name), None) or {}
            kind = asked.get("type", "") if isinstance(asked, dict) else ""
            stand_in = ADAPTERS.get(kind, Adapter).stand_in
            for warning in self.model.load_controller(request.name, stand_in(asked), kind):
                rospy.logwarn("%s: %s" % (self._space, warning))
            try:
                self._adapt(request.name, kind, self.simulation.loaded_controllers()[-1]["joints"])
            except ArasError:
                self.model.unload_controller(request.name)
                raise
        except ArasError as error:
            self._tell("Could not load controller '%s': %s" % (request.name, error))
            return (False,)
        return (True,)

    def _adapt(self, name: str, kind: str, joints: typing.List[str]) -> None:
        """Gives topics to a controller that is loaded."""
        self._adapters[name] = ADAPTERS[kind](name, joined(self._space, name), self._space, self.model, joints,
                                              self.work, self.world)
        self._types_asked[name] = kind

    def _unload(self, request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        self.model.unload_controller(request.name)
        self._adapters.pop(request.name).close()
        return (True,)

    def _switch(self, request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        strictness = request.strictness
        if strictness not in (SwitchControllerRequest.BEST_EFFORT, SwitchControllerRequest.STRICT):
            rospy.logwarn("%s: To switch controllers you need to specify a strictness level of STRICT (2) or "
                          "BEST_EFFORT (1). Defaulting to BEST_EFFORT." % joined(self._space, "controller_manager"))
        self.simulation.switch_controllers(request.start_controllers, request.stop_controllers,
                                           strictness == SwitchControllerRequest.STRICT)
        self._follow()
        return (True,)

    def find_loaded(self) -> None:
        """Gives topics to the controllers that are loaded now: the model became another."""
        loaded = {each["name"]: each for each in self.simulation.loaded_controllers()
                  if each["name"] in self.model.loaded}
        for name in [each for each in self._adapters if each not in loaded]:
            self._adapters.pop(name).close()
        for name, each in loaded.items():
            if name not in self._adapters:
                self._adapt(name, self.model.loaded[name][1], each["joints"])
        self._follow()

    def _follow(self) -> None:
        """Informs the adapters about the running controllers."""
        for each in self._loaded():
            adapter = self._adapters[each["name"]]
            runs = each["state"] == "running"
            if runs and not adapter.running:
                adapter.started(self.world.time_ns)
            elif adapter.running and not runs:
                adapter.stopped()

    def _list(self, _request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        states = []
        for each in self._loaded():
            claimed = HardwareInterfaceResources(each["hardware_interface"], each["joints"])
            states.append(ControllerState(each["name"], each["state"], self._types_asked[each["name"]], [claimed]))
        return (states,)

    @staticmethod
    def _types(_request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        types = sorted(ADAPTERS)
        return types, [BASE_CLASS] * len(types)

    def _reload(self, request: typing.Any) -> typing.Tuple[typing.Any, ...]:
        """Kills all controllers if asked to; there are no libraries to reload."""
        loaded = self._loaded()
        if loaded and not request.force_kill:
            self._tell("Cannot reload controller libraries because there are still %d controllers running" %
                       len(loaded))
            return (False,)
        self.simulation.switch_controllers([], [each["name"] for each in loaded], False)
        self._follow()
        for each in loaded:
            self.model.unload_controller(each["name"])
            self._adapters.pop(each["name"]).close()
        return (True,)

    # --- time

    @property
    def next_ns(self) -> int:
        return min((each.next_ns for each in self._adapters.values()), default=NEVER_NS)

    def publish(self, now_ns: int) -> None:
        for adapter in list(self._adapters.values()):
            adapter.publish(now_ns)

    def time_reset(self, now_ns: int) -> None:
        for adapter in self._adapters.values():
            adapter.time_reset(now_ns)

    def close(self) -> None:
        super().close()
        for adapter in self._adapters.values():
            adapter.close()
