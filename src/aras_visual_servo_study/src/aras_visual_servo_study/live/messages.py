"""Requests of a page to a run: each is described once and validated here. docs/reference/live_messages.md lists them.

A request is a JSON object with `do`, the name of the request, `id`, a number of the page's own that the answer repeats,
and the fields of the request's class:

    {"do": "set", "id": 7, "values": {"servo.gains_per_s.xn": 2.0}}
    {"type": "answer", "id": 7, "ok": true, ...}   or   {..., "ok": false, "faults": ["servo.gains_per_s.xn: ..."]}

The other messages go from the run to every page: see docs/reference/live_messages.md.
"""

import json
from dataclasses import dataclass
from typing import Any, Optional, Tuple, Union

from aras_visual_servo import ParameterError, Registry, read, setting

#: Longest request that is read [bytes].
MOST_BYTES = 65536
REFERENCES = ("experiment", "taught")
#: Name of a request -> settings class with its fields.
REQUESTS = Registry("request")


@REQUESTS.register("start", do="start")
@dataclass(frozen=True)
class Start:
    """Begin to servo with the next image."""

    reference: str = setting(
        "experiment", choices=REFERENCES,
        help="`experiment`: drive to the goal, teach it, drive to the start and servo; `taught`: servo from here to "
             "the goal that was taught last.")


@REQUESTS.register("again", do="again")
@dataclass(frozen=True)
class Again:
    """Drive to the start of the experiment and servo to the goal that was taught last."""


@REQUESTS.register("draw_start", do="draw_start")
@dataclass(frozen=True)
class DrawStart:
    """Ask for another start from which the target is in view; the answer has it as `start`, and nothing moves."""


@REQUESTS.register("stop", do="stop")
@dataclass(frozen=True)
class Stop:
    """End what is going on; the arm stands still."""


@REQUESTS.register("teach", do="teach")
@dataclass(frozen=True)
class Teach:
    """Make the view of the last image the goal."""

    z_star_m: Optional[float] = setting(
        None, unit="m", above=0,
        help="Depth of the target in it; without, the true one along the optical axis.")


@REQUESTS.register("reset", do="reset")
@dataclass(frozen=True)
class Reset:
    """Begin anew, with the settings as they stand now."""


@REQUESTS.register("pause", do="pause")
@dataclass(frozen=True)
class Pause:
    """Stop simulated time, or let it go on."""

    paused: bool = setting(help="Whether time stands still.")


@REQUESTS.register("step", do="step")
@dataclass(frozen=True)
class Step:
    """Let a paused run go on for some images."""

    images: int = setting(1, at_least=1, at_most=1000, help="How many.")


@REQUESTS.register("speed", do="speed")
@dataclass(frozen=True)
class Speed:
    """How fast simulated time goes."""

    factor: float = setting(at_least=0, at_most=1000, help="Simulated time per wall time; 0 is as fast as possible.")


@REQUESTS.register("follow", do="follow")
@dataclass(frozen=True)
class Follow:
    """Whether the servo, once it has ended, begins again when the target has moved."""

    follow: bool = setting(help="True: it begins again.")


@REQUESTS.register("set", do="set")
@dataclass(frozen=True)
class Set:
    """Change settings of the scenario, all of them or, if there is a fault, none."""

    values: object = setting(
        help="Value by path, e.g. `servo.gains_per_s.xn` or `sim.cameras.0.noise_stddev`; null takes a key out.")
    reset: bool = setting(False, help="Begin anew with them, also with those that wait for a reset.")


@REQUESTS.register("offer", do="offer")
@dataclass(frozen=True)
class Offer:
    """Ask what has to be set so that another law can servo; nothing changes."""

    law: str = setting(not_empty=True, help="Its name; the answer has `features`, `values` and `reset` for `set`.")


@REQUESTS.register("write_law", do="write_law")
@dataclass(frozen=True)
class WriteLaw:
    """Use a law from the next servo on; only with `--edit`. The answer has its name as `law`."""

    text: str = setting(not_empty=True, help="Python code that registers one law, as in docs/extending.md.")


@REQUESTS.register("place_target", do="place_target")
@dataclass(frozen=True)
class PlaceTarget:
    """Put the target somewhere; it stays there."""

    position_m: Tuple[float, ...] = setting(size=3, unit="m", help="Where its origin is in the world.")
    q_xyzw: Tuple[float, ...] = setting(size=4, help="Its attitude, a unit quaternion.")


@REQUESTS.register("reach", do="reach")
@dataclass(frozen=True)
class Reach:
    """Ask where on its plane the target may lie, so that the arm can bring the camera to the taught view."""


@REQUESTS.register("move_target", do="move_target")
@dataclass(frozen=True)
class MoveTarget:
    """Give the target a motion from where it is."""

    motion: object = setting(None, help="As `sim.scene.models[].motion` of a scenario; null: it stays where it is.")


@REQUESTS.register("joint", do="joint")
@dataclass(frozen=True)
class Joint:
    """Drive one joint by hand, while nothing is servoed."""

    name: str = setting(not_empty=True, help="Its name.")
    position: float = setting(unit="m, rad", help="Where to, within its limits.")


@REQUESTS.register("lesson", do="lesson")
@dataclass(frozen=True)
class SetLesson:
    """Set the scene of a lesson and run it, or leave the lesson; the run begins anew."""

    name: Optional[str] = setting(
        None, help="Its name; without, the lesson is left, and the scenario of before it comes back.")


@REQUESTS.register("try_lesson", do="try_lesson")
@dataclass(frozen=True)
class TryLesson:
    """Run the scene of the lesson with one thing changed, and check the answer against the run."""

    change: str = setting(not_empty=True, help="One of the changes of the lesson.")
    answer: str = setting(not_empty=True, help="Predicted answer, a key of the lesson's answers.")


@REQUESTS.register("save", do="save")
@dataclass(frozen=True)
class Save:
    """Ask for what stands there as a scenario file; the answer has it as `yaml`."""

    name: str = setting("live", not_empty=True, help="Name of the scenario.")
    start_here: bool = setting(False, help="The arm's position now becomes the start of the experiment.")


def parse(text: Union[str, bytes]) -> Tuple[Optional[int], Any]:
    """Returns (id, request) of a message of a page.

    Raises: ParameterError: it is no request; its attribute `id` is that of the message, None if it has none.
    """
    number = None
    try:
        if len(text) > MOST_BYTES:
            raise ParameterError(f"message: found {len(text)} bytes, allowed <= {MOST_BYTES}")
        try:
            fields = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise ParameterError(f"message: found {_short(text)}, allowed JSON: {error}") from error
        if not isinstance(fields, dict):
            raise ParameterError(f"message: found {_short(fields)}, allowed an object with the key do")
        found, name = fields.pop("id", None), fields.pop("do", None)
        if not isinstance(found, (int, type(None))):
            raise ParameterError(f"message: found the id {_short(found)}, allowed a whole number")
        number = found
        if not isinstance(name, str) or name not in REQUESTS:
            raise ParameterError(f"message: found do {_short(name)}, allowed {', '.join(REQUESTS)}")
        return number, read(REQUESTS[name], fields, name)
    except ParameterError as error:
        setattr(error, "id", number)
        raise


def _short(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
