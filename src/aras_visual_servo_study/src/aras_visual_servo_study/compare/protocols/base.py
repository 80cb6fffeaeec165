"""Protocols of the field: starts, scene, law and measure of success as a publication has them, under the name of it.

    @register_protocol("mine")
    class Mine(Protocol):
        title, source, metric, published_starts = "...", "A. Uthor, 2024", "success", 100
        def cases(self, folder, count): ...

A protocol is a list of `Case`: each is a scenario, its starts, and what is published of it. `runner` runs them as a
sweep and makes the table. The simulated time of an iteration is fixed by the scenario, so that the outcome does not
depend on the speed of the machine.
"""

from dataclasses import dataclass, field
from typing import Dict, List, Tuple

import numpy as np

from aras_visual_servo import ParameterError, load_room

_PROTOCOLS = {}


@dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes:
        name: of the case and of its folder.  scenario: `Scenario`.  starts: list of `Start`.
        columns: what tells this case from the others, {heading: text}.
        published: (rate, whose) of the publication, rate in [0, 1]; None: nothing is published of it.
    """

    name: str
    scenario: object
    starts: List[object]
    columns: Dict[str, str] = field(default_factory=dict)
    published: Tuple[float, str] = None


class Protocol:
    """Base class of the protocols.

    Attributes:
        name: under which it is registered.  title: one line.  source: the publication.
        metric: name of the metric that counts (`sweep.metrics`).  published_starts: how many starts it has.
        takes: what of a user's own takes the place of ours: `board`, the file of a picture; `meshes`, a folder.
    """

    name, title, source, metric, published_starts, takes = "", "", "", "success", 0, ()

    def cases(self, folder, count, **own):
        """The cases, list of `Case`.

        Args:
            folder: where files that the cases need are written (Path).  count: starts of each case, at most
            published_starts; fewer are spread evenly over those of the protocol.
            own: of the user's, by the names in `takes`; what is missing or None is ours.
        Raises ParameterError.
        """
        raise NotImplementedError

    def check_own(self, own):
        """Raises ParameterError: this protocol does not take one of these, {name: text}."""
        for name, found in own.items():
            if name not in self.takes:
                allowed = ", ".join(f"--{one}" for one in self.takes) or "neither --board nor --meshes"
                raise ParameterError(f"--{name}: found {found}, but the protocol {self.name} takes {allowed}")

    def lines(self, case, rows):
        """The lines of the table that a case has: list of (columns, rows), columns {heading: text}."""
        return [(case.columns, rows)]

    def save_pictures(self, results, folder):
        """Draw what a table does not show. results: list of (Case, rows). Returns the paths that were written."""
        return []


def register_protocol(name):
    """Class decorator that makes a protocol known by name."""

    def add(protocol):
        protocol.name = name
        _PROTOCOLS[name] = protocol()
        return protocol

    return add


def known_protocols():
    """The registered protocols, sorted by name."""
    load_room(__package__)
    return [_PROTOCOLS[name] for name in sorted(_PROTOCOLS)]


def protocol_named(name):
    """The `Protocol` of that name. Raises ParameterError, listing the known ones."""
    for protocol in known_protocols():
        if protocol.name == name:
            return protocol
    raise ParameterError(f"benchmark: found '{name}', allowed {', '.join(one.name for one in known_protocols())}")


def spread(count, total):
    """Indices of `count` of `total` things, as evenly as possible, both ends included. Raises ParameterError."""
    if not 1 <= count <= total:
        raise ParameterError(f"starts: found {count}, allowed 1 to {total}")
    return [0] if count == 1 else [round(i * (total - 1) / (count - 1)) for i in range(count)]


def halton(count, bases):
    """(count, len(bases)) in (0, 1): a Halton sequence without its first point, which covers the cube evenly."""
    return np.array([[_mirrored(i, base) for base in bases] for i in range(1, count + 1)])


def _mirrored(number, base):
    """Digits of a number to a base, mirrored at the point."""
    value, place = 0.0, 1.0 / base
    while number:
        number, digit = divmod(number, base)
        value, place = value + digit * place, place / base
    return value
