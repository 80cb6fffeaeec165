"""Requested wrenches on links and efforts on joints, each from its start to its end."""
import collections
import dataclasses
import typing

import numpy

NEVER_NS = 2 ** 62  #: a time that never comes


@dataclasses.dataclass(frozen=True)
class Push:
    """One of them. `what` is a link or a joint of the model; `value` is (6,) [f; tau] in world axes at the centre of
    mass of the link [N; N m], or the effort of a joint [N or N m]."""
    model: str
    what: str
    is_joint: bool
    value: object
    begin_ns: int
    end_ns: int


class Pushes:
    """All of a world. Those that act at the same time on one link or joint add up."""

    def __init__(self, models: typing.Dict[str, typing.Any]) -> None:
        """Args: models: dict of name -> Model, of the world."""
        self._models, self._pushes = models, []
        self._pushed = set()

    def add(self, model: str, what: str, is_joint: bool, value: typing.Any, begin_ns: int, duration_ns: int,
            period_ns: int, now_ns: int) -> None:
        """Lets a push act from begin_ns, or from now if that is over, for a duration; a negative one never ends, and
        one of 0 acts for a period."""
        begin_ns = max(begin_ns, now_ns)
        end_ns = NEVER_NS if duration_ns < 0 else begin_ns + max(duration_ns, period_ns)
        self._pushes.append(Push(model, what, is_joint, value, begin_ns, end_ns))
        self.act(now_ns)

    def clear(self, model: str, what: str, is_joint: bool, now_ns: int) -> None:
        """Ends all that act on a link or joint."""
        self._pushes = [push for push in self._pushes
                        if (push.model, push.what, push.is_joint) != (model, what, is_joint)]
        self.act(now_ns)

    def forget(self, model: typing.Optional[str] = None) -> None:
        """Those of a model that is gone, or all."""
        self._pushes = [push for push in self._pushes if model is not None and push.model != model]
        self.act(0)

    @property
    def next_ns(self) -> int:
        """When one of them begins or ends."""
        return min((time for push in self._pushes for time in (push.begin_ns, push.end_ns) if time > self._acted_ns),
                   default=NEVER_NS)

    def entries(self) -> typing.List[typing.Dict[str, typing.Any]]:
        """All there are, as JSON has them."""
        return [dict(vars(push), value=numpy.asarray(push.value, float).tolist()) for push in self._pushes]

    def become(self, entries: typing.List[typing.Dict[str, typing.Any]], now_ns: int) -> None:
        """Makes these the pushes there are."""
        self._pushes = [Push(**entry) for entry in entries]
        self.act(now_ns)

    _acted_ns = -1

    def act(self, now_ns: int) -> None:
        """Applies the current pushes until the next call. Call it at every stop of the world."""
        self._acted_ns = now_ns
        self._pushes = [push for push in self._pushes if push.end_ns > now_ns]
        links, joints = collections.defaultdict(dict), collections.defaultdict(dict)
        for push in self._pushes:
            if push.begin_ns <= now_ns and push.model in self._models:
                values = (joints if push.is_joint else links)[push.model]
                values[push.what] = values.get(push.what, 0.0) + numpy.asarray(push.value, float)
        for name in self._pushed | set(links) | set(joints):
            if name in self._models:
                self._models[name].push(
                    links[name], {joint: float(effort) for joint, effort in joints[name].items()})
        self._pushed = {name for name in self._models if links.get(name) or joints.get(name)}
