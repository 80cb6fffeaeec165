"""Base class of the controller adapters: a controller's place in the world and in the ROS graph."""
import typing

from ..node.outlet import Outlet
from ..node.work import Work
from ..world.model import Model
from ..world.world import World

Parameters = typing.Dict[str, typing.Any]  #: of a controller, as rosparam has them
AdapterClass = typing.Type["Adapter"]

#: Class that serves each type of controller.
ADAPTERS: typing.Dict[str, AdapterClass] = {}


def register(*types: str) -> typing.Callable[[AdapterClass], AdapterClass]:
    """Decorator: the class serves these types of controllers."""
    def note(adapter: AdapterClass) -> AdapterClass:
        ADAPTERS.update(dict.fromkeys(types, adapter))
        return adapter
    return note


class Adapter(Outlet):
    """Topics of one loaded controller; send() is called while it runs.

    Attributes:
        name: of the controller.  place: full name, of its parameters and topics.  space: full name of its manager's
        namespace.  joints: that it drives.
    """

    def __init__(self, name: str, place: str, space: str, model: Model, joints: typing.List[str], work: Work,
                 world: World) -> None:
        self.name, self.place, self.space, self.joints = name, place, space, joints
        self.running = False
        super().__init__(world, model, work)

    @staticmethod
    def stand_in(parameters: Parameters) -> Parameters:
        """Returns the simulator's parameters for those of such a controller. Raises: ArasError."""
        return parameters

    def topic(self, name: str) -> str:
        return self.place + "/" + name

    def wanted(self) -> bool:
        return self.running and super().wanted()

    def started(self, now_ns: int) -> None:
        """Its controller runs from now on."""
        self.running = True
        self.begin(now_ns)

    def stopped(self) -> None:
        self.running = False

    def time_reset(self, now_ns: int) -> None:
        if self.running:
            self.started(now_ns)
