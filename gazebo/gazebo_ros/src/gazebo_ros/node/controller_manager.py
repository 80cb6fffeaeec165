"""ros_control's controller manager of one model: its services, and the topics of the controllers that are loaded."""
import rospy
from controller_manager_msgs.msg import ControllerState, HardwareInterfaceResources
from controller_manager_msgs.srv import (ListControllers, ListControllersResponse, ListControllerTypes,
                                         ListControllerTypesResponse, LoadController, LoadControllerResponse,
                                         ReloadControllerLibraries, ReloadControllerLibrariesResponse,
                                         SwitchController, SwitchControllerRequest, SwitchControllerResponse,
                                         UnloadController, UnloadControllerResponse)

from aras_visual_servo_sim import ArasError, Simulation

from ..controllers import adapter_of, parameters_of, types_of_adapters
from ..world.devices import joined
from .beat import NEVER_NS

BASE_CLASS = "controller_interface::ControllerBase"


class ControllerManager:
    """Answers as controller_manager does: false, with an error in the log, for what cannot be done."""

    def __init__(self, world, model, work):
        self._world, self._model, self._work = world, model, work
        self._space = model.description.control_namespace
        self._adapters, self._types_asked = {}, {}
        self._services = [
            self._serve("load_controller", LoadController, self._load),
            self._serve("unload_controller", UnloadController, self._unload),
            self._serve("switch_controller", SwitchController, self._switch),
            self._serve("list_controllers", ListControllers, self._list),
            self._serve("list_controller_types", ListControllerTypes, self._types),
            self._serve("reload_controller_libraries", ReloadControllerLibraries, self._reload)]

    def _serve(self, name, kind, answer):
        return rospy.Service(joined(self._space, "controller_manager", name), kind,
                             lambda request: self._work.call(lambda: answer(request)))

    @property
    def _simulation(self):
        return self._model.simulation

    def _loaded(self):
        """Those of ros_control: wheels that a plugin drives are not among them."""
        return [each for each in self._simulation.loaded_controllers() if each["name"] in self._adapters]

    def _tell(self, text):
        rospy.logerr("%s: %s" % (joined(self._space, "controller_manager"), text))

    # --- services

    def _load(self, request):
        place = joined(self._space, request.name)
        try:
            asked = rospy.get_param(place, None) or {}
            kind = asked.get("type", "") if isinstance(asked, dict) else ""
            warnings = self._model.load_controller(request.name, parameters_of(asked), kind)
        except ArasError as error:
            self._tell("Could not load controller '%s': %s" % (request.name, error))
            return LoadControllerResponse(ok=False)
        for warning in warnings:
            rospy.logwarn("%s: %s" % (self._space, warning))
        loaded = self._simulation.loaded_controllers()[-1]
        try:
            self._adapters[request.name] = adapter_of(asked["type"])(
                request.name, place, self._space, self._model, loaded["joints"], self._work, self._world)
        except ArasError as error:
            self._model.unload_controller(request.name)
            self._tell("Could not load controller '%s': %s" % (request.name, error))
            return LoadControllerResponse(ok=False)
        self._types_asked[request.name] = asked["type"]
        return LoadControllerResponse(ok=True)

    def _unload(self, request):
        try:
            self._model.unload_controller(request.name)
        except ArasError as error:
            self._tell(str(error))
            return UnloadControllerResponse(ok=False)
        self._adapters.pop(request.name).close()
        return UnloadControllerResponse(ok=True)

    def _switch(self, request):
        strictness = request.strictness
        if strictness not in (SwitchControllerRequest.BEST_EFFORT, SwitchControllerRequest.STRICT):
            rospy.logwarn("%s: To switch controllers you need to specify a strictness level of STRICT (2) or "
                          "BEST_EFFORT (1). Defaulting to BEST_EFFORT." % joined(self._space, "controller_manager"))
        try:
            self._simulation.switch_controllers(request.start_controllers, request.stop_controllers,
                                                strictness == SwitchControllerRequest.STRICT)
        except ArasError as error:
            self._tell(str(error))
            return SwitchControllerResponse(ok=False)
        self._follow()
        return SwitchControllerResponse(ok=True)

    def find_loaded(self):
        """Gives topics to the controllers that are loaded now: the model became another."""
        loaded = {each["name"]: each for each in self._simulation.loaded_controllers()
                  if each["name"] in self._model.loaded}
        for name in [each for each in self._adapters if each not in loaded]:
            self._adapters.pop(name).close()
        for name, each in loaded.items():
            if name not in self._adapters:
                self._types_asked[name] = self._model.loaded[name][1]
                self._adapters[name] = adapter_of(self._types_asked[name])(
                    name, joined(self._space, name), self._space, self._model, each["joints"], self._work, self._world)
        self._follow()

    def _follow(self):
        """Tells the adapters what runs now."""
        for each in self._loaded():
            adapter = self._adapters[each["name"]]
            runs = each["state"] == "running"
            if runs and not adapter.running:
                adapter.started(self._world.time_ns)
            elif adapter.running and not runs:
                adapter.stopped()

    def _list(self, _request):
        states = []
        for each in self._loaded():
            claimed = HardwareInterfaceResources(each["hardware_interface"], each["joints"])
            states.append(ControllerState(each["name"], each["state"], self._types_asked[each["name"]], [claimed]))
        return ListControllersResponse(states)

    @staticmethod
    def _types(_request):
        types = sorted(Simulation.controller_types() + types_of_adapters())
        return ListControllerTypesResponse(types, [BASE_CLASS] * len(types))

    def _reload(self, request):
        """There are no libraries: what can be done is to kill all controllers."""
        loaded = self._loaded()
        if loaded and not request.force_kill:
            self._tell("Cannot reload controller libraries because there are still %d controllers running" %
                       len(loaded))
            return ReloadControllerLibrariesResponse(ok=False)
        self._simulation.switch_controllers([], [each["name"] for each in loaded], False)
        self._follow()
        for each in loaded:
            self._model.unload_controller(each["name"])
            self._adapters.pop(each["name"]).close()
        return ReloadControllerLibrariesResponse(ok=True)

    # --- time

    @property
    def next_ns(self):
        return min((each.next_ns for each in self._adapters.values()), default=NEVER_NS)

    def publish(self, now_ns):
        for adapter in list(self._adapters.values()):
            adapter.publish(now_ns)

    def time_reset(self, now_ns):
        for adapter in self._adapters.values():
            adapter.time_reset(now_ns)

    def close(self):
        for service in self._services:
            service.shutdown("the model is gone")
        for adapter in self._adapters.values():
            adapter.close()
        self._adapters = {}
