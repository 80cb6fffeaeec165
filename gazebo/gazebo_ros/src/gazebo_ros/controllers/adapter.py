"""What the adapters of all types of controllers share: a controller's place in the world and in the ROS graph."""
from ..node.outlet import Outlet

#: Class that serves each type of controller.
ADAPTERS = {}


def register(*types):
    """Decorator: the class serves these types of controllers."""
    def note(adapter):
        ADAPTERS.update(dict.fromkeys(types, adapter))
        return adapter
    return note


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

    @staticmethod
    def stand_in(parameters):
        """What the simulator is to load for the parameters of such a controller. Raises: ArasError."""
        return parameters

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
