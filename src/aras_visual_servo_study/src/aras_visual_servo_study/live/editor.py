"""The law that is written in the page: checked at once, used from the next servo on, left again when it fails.

A text runs with all rights of this process, so there is an editor only where it was asked for, and only for
pages of this machine: `aras-servo live --edit`.
"""

from typing import Any, Callable, Dict, List, Optional

from aras_visual_servo import ArasError, ParameterError, ServoRecord, Status, WrittenLaw, code_place

#: How an error of the text begins, where its line is known.
PLACE = "law.py:"
#: How the reason of a servo begins that its law has ended.
OF_LAW = ("law '", "not finite: ")
EXAMPLE = '''\
import numpy as np
from aras_visual_servo import Law, register_law


@register_law("mine")
class Mine(Law):
    works_on, needs_plane = None, True   # any features

    def _twist(self, look, s, e):
        # s: the features; e: their errors, s minus s at the goal. Both have one number for each
        # name of "features" below "Law and gains", in that order: lengths in m, angles in rad.
        # L: change of each feature (row) per twist (column). Gains in 1/s, in the order of e.
        L = self.features.matrix(look.view)
        twist = -self.invert(L) @ (np.array(self.gains_per_s) * e)
        # The camera's velocity [vx, vy, vz, wx, wy, wz] in its own frame (x right, y down,
        # z forwards), in m/s and rad/s. Here never faster than 0.1 m/s:
        return twist / max(1.0, np.linalg.norm(twist[:3]) / 0.1)
'''


class LawEditor:
    """Holds the texts.

    Args: take: function (name of a law) that makes the run servo with it from now on. ArasError: it cannot.
        tried: the same, but nothing changes.
    Attributes: text: of the newest law that was accepted, or the example.
    """

    def __init__(self, take: Callable[[str], None], tried: Callable[[str], Any]) -> None:
        self._take, self._tried, self.text = take, tried, EXAMPLE
        self._waiting: Optional[WrittenLaw] = None
        self._used: Optional[WrittenLaw] = None
        self._before: Optional[WrittenLaw] = None
        self._newest: Optional[WrittenLaw] = None
        self._former, self._again, self._status = "", "", Status.IDLE
        self._faults: List[str] = []

    def write(self, text: str) -> Dict[str, Any]:
        """Accepts a text, which `follow` uses. Returns its law for JSON. Raises ParameterError; nothing has changed."""
        law = WrittenLaw(text)
        with law.tried():
            try:
                self._tried(law.name)
            except Exception as error:  # also whatever the text raises when its law is made
                place = code_place(error)
                if isinstance(error, ArasError) and not place:
                    raise
                raise ParameterError(f"{place}{type(error).__name__}: {error}") from error
        self.text, self._newest, self._waiting, self._faults, self._again = text, law, law, [], ""
        return {"law": law.name}

    def begin(self, law: str) -> None:
        """Uses the law that waits, because a servo begins. Args: law: name of the one in use."""
        self._status = Status.IDLE
        if self._waiting is not None:
            waiting, self._waiting = self._waiting, None
            self._use(waiting, law)

    def follow(self, law: str, record: ServoRecord, servoing: bool) -> None:
        """Looks at the answer to an image: leaves a law that has failed, and uses the one that waits after a servo.

        Args: law: name of the one in use.  servoing: whether a servo goes on.
        """
        before, self._status = self._status, record.status
        text = record.status_text
        if record.status == Status.FAULT != before and text.startswith(OF_LAW) and self._used and self.has(law):
            self._leave(text if PLACE in text else self._used.place + text)
        elif not servoing and self._waiting is not None:
            self.begin(law)
            self._status = record.status

    def _leave(self, fault: str) -> None:
        used, self._faults = self._used, [fault]
        if self._before is not None:
            self._before.put()
        try:
            self._take(self._former)
        except ArasError:  # settings have changed since: the next servo fails in the same place
            if used is not None:
                used.put()
            return
        self._again = self._former + (" as it was written before" if self._before is not None else "")
        self._used, self._before = self._before, None

    def _use(self, law: WrittenLaw, former: str) -> None:
        before = self._used if self.has(former) else None
        law.put()
        try:
            self._take(law.name)
        except ArasError as error:  # settings have changed since it was written
            if before is not None:
                before.put()
            self._faults = str(error).splitlines()
            return
        self._used, self._before, self._former = law, before, former

    def has(self, law: str) -> bool:
        """Returns whether a law, by name, is the one that was written here and is in use."""
        return self._used is not None and self._used.name == law

    def state(self, law: str) -> Dict[str, Any]:
        """Returns, for JSON, how the newest text stands. Args: law: name of the one in use.

        law: its name, "" if it is not that of the newest text.  waits: whether the newest one is used from the next
        servo on.  faults: of the last servo, or why the text could not be used.  again: the law that is used again
        since that servo, in words; "" if there is none.
        """
        return {"law": law if self.has(law) and self._used is self._newest else "", "waits": self._waiting is not None,
                "faults": self._faults, "again": self._again}
