"""What all of them share: a controller's place in the world and in the ROS graph."""
import rospy

from aras_visual_servo_sim import ArasError

from ..node.beat import NEVER_NS

_ADAPTERS = {}
_STAND_INS = {}


def register(*types):
    """Decorator: the class serves these types of controllers."""
    def note(adapter):
        _ADAPTERS.update((each, adapter) for each in types)
        return adapter
    return note


def adapter_of(kind):
    """Class that serves a type of controller."""
    return _ADAPTERS[kind]


def stands_for(kind):
    """Decorator: f(parameters) gives those of a controller that the simulator has in the place of this type."""
    def note(translate):
        _STAND_INS[kind] = translate
        return translate
    return note


def parameters_of(parameters):
    """What the simulator is to load for the parameters of a controller. Raises: ArasError."""
    translate = _STAND_INS.get(parameters.get("type") if isinstance(parameters, dict) else None)
    return parameters if translate is None else translate(parameters)


def types_of_adapters():
    """Types that are known here and not to the simulator."""
    return list(_STAND_INS)


class Adapter:
    """Topics of one loaded controller. Everything but the callbacks of rospy runs in the world's thread.

    Attributes:
        name: of the controller.  place: full name, of its parameters and topics.  space: full name of its manager's
        namespace.  model: Model.  joints: that it drives.  next_ns: when publish() wants to be called.
    """

    def __init__(self, name, place, space, model, joints, work, world):
        self.name, self.place, self.space, self.model, self.joints = name, place, space, model, joints
        self.work, self.world = work, world
        self.running = False
        self._ends = []
        self.open()

    @property
    def simulation(self):
        return self.model.simulation

    @property
    def next_ns(self):
        return NEVER_NS

    def topic(self, name):
        return self.place + "/" + name

    def advertise(self, name, kind, **options):
        publisher = rospy.Publisher(name, kind, queue_size=10, **options)
        self._ends.append(publisher.unregister)
        return publisher

    def listen(self, name, kind, react):
        """react(message) is called in the world's thread; what it refuses is logged."""
        def answer(message):
            try:
                react(message)
            except ArasError as error:
                rospy.logerr("%s: %s" % (self.place, error))
        subscriber = rospy.Subscriber(name, kind, lambda message: self.work.post(lambda: answer(message)))
        self._ends.append(subscriber.unregister)

    def ends_with(self, action):
        """action() is called at the end."""
        self._ends.append(action)

    # --- what a type of controller does of its own

    def open(self):
        """Makes its topics."""

    def started(self, now_ns):
        """Its controller runs from now on."""
        self.running = True

    def stopped(self):
        self.running = False

    def publish(self, now_ns):
        """Called at every stop of the world."""

    def time_reset(self, now_ns):
        """Time went back."""
        if self.running:
            self.started(now_ns)

    def close(self):
        for end in reversed(self._ends):
            end()
        self._ends = []
