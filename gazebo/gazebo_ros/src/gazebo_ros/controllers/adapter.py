"""What the adapters of all types of controllers share: a controller's place in the world and in the ROS graph."""
from ..node.outlet import Outlet

_ADAPTERS = {}
_STAND_INS = {}


def register(*types, stand_in=None):
    """Decorator: the class serves these types of controllers. stand_in(parameters) gives those of a controller that the
    simulator has in the place of these types."""
    def note(adapter):
        _ADAPTERS.update((each, adapter) for each in types)
        _STAND_INS.update((each, stand_in) for each in types if stand_in)
        return adapter
    return note


def adapter_of(kind):
    """Class that serves a type of controller."""
    return _ADAPTERS[kind]


def parameters_of(parameters):
    """What the simulator is to load for the parameters of a controller. Raises: ArasError."""
    translate = _STAND_INS.get(parameters.get("type") if isinstance(parameters, dict) else None)
    return parameters if translate is None else translate(parameters)


def types_of_adapters():
    """Types that are known here and not to the simulator."""
    return list(_STAND_INS)


class Adapter(Outlet):
    """Topics of one loaded controller; send() is called while it runs.

    Attributes:
        name: of the controller.  place: full name, of its parameters and topics.  space: full name of its manager's
        namespace.  joints: that it drives.
    """

    def __init__(self, name, place, space, model, joints, work, world):
        self.name, self.place, self.space, self.joints = name, place, space, joints
        self.running = False
        super().__init__(world, model, work)

    def topic(self, name):
        return self.place + "/" + name

    def wanted(self):
        return self.running and super().wanted()

    def started(self, now_ns):
        """Its controller runs from now on."""
        self.running = True
        self.begin(now_ns)

    def stopped(self):
        self.running = False

    def time_reset(self, now_ns):
        if self.running:
            self.started(now_ns)
