"""The stages of the servo: each takes the state at one image, a `Tick`, and returns it.

    @register_stage("slow", settings=SlowSettings)
    class Slow(Stage):
        def apply(self, tick):
            return tick.set(twist=0.5 * tick.twist)

A gate returns `tick.rest(status, text)` where the arm must stand still. The servo makes new stages at each start, so
that a stage keeps its state in its own attributes.
"""

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any, Callable, Optional, Tuple, Type, TypeVar

import numpy as np

from ..config.settings import register, settings_of
from ..features.base import View
from ..ground.errors import ParameterError
from ..ground.registry import Registry
from ..ground.types import Observation, Reference, Status
from ..laws.look import Answer

if TYPE_CHECKING:  # C++: not needed to describe the settings of a stage
    from ..arm.kinematics import RobotKinematics

#: tilt_rad, position_m, rotation_rad of an image that tells none of them.
UNKNOWN = (float("nan"),) * 3
#: Not known before a stage has set it.
LATER: Any = None


@dataclass(slots=True)
class Tick:
    """Inputs and outputs of the stages at one image. Each tick begins as the last one with a new observation.

    Attributes:
        stamp_ns: time of the image [ns].  dt_s: time to the next image, through which the answer holds [s].
        features: `Features` or any object with its attributes; None: no image, or a target that is not seen.
        q: (n,) joint positions of the image [m, rad].
        tilt_part: part of `tilt_gain_per_s` in use.
        X_BC: (4, 4) pose of the camera in the base at q.  view: `View` that the law was given.
        answer: of the law.  twist: (6,) V_C wanted, [v; w] in the camera frame [m/s; rad/s];
            at the end what the arm does.
        jacobian: J_BC_C, (6, n), at q.  inverse: its `TwistInverse` solution.  manipulability: there [-].
        judged: (tilt_rad, position_m, rotation_rad) as the stop rule judges them; NaN where unknown.
        pose: (6,) displacement of the camera from the goal that the errors stand for (T60); None: not known.
        applied: (6,) V_C that the arm was given at the last image; None: it was at rest.
        status, text: `Status`, and why.
        held: reason why the arm cannot do the requested motion at this image; "" if it can.
        q_dot: (n,) joint velocities of the command [m/s, rad/s]; None: not decided, the next stage goes on.
        set_point: (n,) joint positions of the command, None: none.  rests: the arm is stopped at this image.
        over: the servo ends with this image, whatever its status.
    """

    stamp_ns: int
    dt_s: float
    features: Optional[Any]
    q: np.ndarray
    answer: Answer
    tilt_part: float = 1.0
    X_BC: np.ndarray = LATER
    view: View = LATER
    twist: np.ndarray = field(default_factory=lambda: np.zeros(6))
    jacobian: np.ndarray = LATER
    inverse: Any = LATER
    manipulability: float = float("nan")
    judged: Tuple[float, float, float] = UNKNOWN
    pose: Optional[np.ndarray] = None
    applied: Optional[np.ndarray] = None
    status: Status = Status.IDLE
    text: str = ""
    held: str = ""
    q_dot: np.ndarray = LATER
    set_point: Optional[np.ndarray] = None
    rests: bool = False
    over: bool = False

    def next(self, observation: Observation, q: np.ndarray, dt_s: float) -> "Tick":
        """Returns a new tick for the next image, taken at joint positions q, (n,)."""
        return Tick(observation.stamp_ns, dt_s, observation.features, q, self.answer, twist=self.twist,
                    manipulability=self.manipulability, judged=self.judged, applied=self.applied, status=self.status,
                    text=self.text)

    def set(self, **changes: Any) -> "Tick":
        """Sets attributes, and returns the tick."""
        for name, value in changes.items():
            setattr(self, name, value)
        return self

    def rest(self, status: Status, text: str) -> "Tick":
        """Returns the tick with zero velocity. A status of `FINAL` ends the servo; others last for this image."""
        return self.set(status=status, text=text, twist=np.zeros(6), applied=None, q_dot=np.zeros(len(self.q)),
                        rests=True)


class Stage:
    """Base class of the stages.

    Attributes:
        name: under which the stage is registered.  settings_class, settings: its own, class and instance; or None.
    """

    name: str = ""
    settings_class: Optional[type] = None

    def __init__(self, kinematics: "RobotKinematics", config: Any) -> None:
        """Args: config: `ServoSettings`."""
        self.kinematics, self.config, self.settings = kinematics, config, None
        if self.settings_class is not None:
            self.settings = settings_of(self.name, self.settings_class, config.settings, f"stage '{self.name}'")

    @property
    def title(self) -> str:
        """Returns the name of the stage for faults."""
        return f"stage '{self.name or type(self).__name__}'"

    def set_reference(self, reference: Reference) -> None:
        """Takes over the goal, a `Reference`."""

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the decision of this stage."""
        raise NotImplementedError

    def rest(self, tick: Tick) -> Tick:
        """Returns the tick of an image at which the arm is stopped, by whichever stage."""
        return tick


STAGES: Registry[Type[Stage]] = Registry("stage")
S = TypeVar("S", bound=Stage)


def register_stage(name: str, settings: Optional[type] = None) -> Callable[[Type[S]], Type[S]]:
    """Returns a class decorator that makes a stage known by name, for `servo.stages` of a scenario.

    Args and errors: of `settings.register`.
    """
    return register(STAGES, name, settings, name=name)


def six_numbers(twist: Any) -> np.ndarray:
    """Returns a twist as an array, (6,). Raises ParameterError: it is not six finite numbers."""
    if getattr(twist, "shape", None) != (6,):
        twist = np.asarray(twist)
        if twist.shape != (6,) or twist.dtype.kind not in "fiu":
            raise ParameterError("the twist is not six finite numbers")
    if not isfinite(sum(twist.tolist())):
        raise ParameterError("the twist is not six finite numbers")
    return twist


class SixNumbers(Stage):
    """Checks the twist after a stage that a scenario names."""

    def __init__(self, name: str) -> None:
        self.name = name

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick, its twist an array. Raises ParameterError: it is not six finite numbers."""
        tick.twist = six_numbers(tick.twist)
        if not tick.held and not tick.twist.any() and tick.answer.twist.any():
            tick.held = f"stage '{self.name}' asks for no motion"
        return tick
