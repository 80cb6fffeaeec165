"""Protocols of the field: starts, scene, law and measure of success as a publication has them, under the name of it.

    @register_protocol("mine")
    class Mine(Protocol):
        title, source, metric, published_starts = "...", "A. Uthor, 2024", "success", 100
        def cases(self, folder, count): ...

A protocol is a list of `Case`: each is a scenario, its starts, and what is published of it. `runner` runs them as a
sweep and makes the table. The simulated time of an iteration is fixed by the scenario, so that the outcome does not
depend on the speed of the machine.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar

import numpy as np

from aras_visual_servo import ParameterError, Registry, Scenario

PROTOCOLS: Registry[Type["Protocol"]] = Registry("benchmark", __package__)
P = TypeVar("P", bound="Protocol")


@dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes:
        name: of the case and of its folder.  starts: list of `Start`.
        columns: what tells this case from the others, {heading: text}.
        published: (rate, whose) of the publication, rate in [0, 1]; None: nothing is published of it.
    """

    name: str
    scenario: Scenario
    starts: List[Any]
    columns: Dict[str, str] = field(default_factory=dict)
    published: Optional[Tuple[float, str]] = None


class Protocol:
    """Base class of the protocols.

    Attributes:
        name: under which it is registered.  title: one line.  source: the publication.
        metric: name of the metric that counts (`sweep.metrics`).  published_starts: how many starts it has.
        takes: what of a user's own takes the place of ours: `board`, the file of a picture; `meshes`, a folder.
    """

    name, title, source, metric, published_starts, takes = "", "", "", "success", 0, ()

    def cases(self, folder: Path, count: int, **own: Any) -> List[Case]:
        """Returns the cases, with `count` starts each. Files that they need are written to `folder`.

        Args: own: of the user's, by the names in `takes`; what is missing or None is ours.
        """
        raise NotImplementedError

    def changed_cases(self, folder: Path, count: int, changes: Dict[str, Any], **own: str) -> List[Case]:
        """Returns the cases with `changes` (dotted path -> value) in their scenarios; the starts stay the same.

        A protocol that compares laws overrides this, and takes `servo.law` as the only law to run.
        """
        columns = {"law": changes["servo.law"]} if "servo.law" in changes else {}
        return [replace(case, scenario=case.scenario.with_overrides(changes), columns={**case.columns, **columns})
                if changes else case for case in self.cases(folder, count, **own)]

    def check_own(self, own: Mapping[str, Any]) -> None:
        """Raises ParameterError: this protocol does not take one of these, {name: text}."""
        for name, found in own.items():
            if name not in self.takes:
                allowed = ", ".join(f"--{one}" for one in self.takes) or "neither --board nor --meshes"
                raise ParameterError(f"--{name}: found {found}, but the protocol {self.name} takes {allowed}")

    def lines(self, case: Case, rows: List[Dict[str, Any]]) -> List[Tuple[Dict[str, Any], List[Dict[str, Any]]]]:
        """The lines of the table that a case has: list of (columns, rows), columns {heading: text}."""
        return [(case.columns, rows)]

    def save_pictures(self, results: List[Tuple[Case, List[Dict[str, Any]]]], folder: Path) -> List[Path]:
        """Draw what a table does not show. results: list of (Case, rows). Returns the paths that were written."""
        return []


def register_protocol(name: str) -> Callable[[Type[P]], Type[P]]:
    """Returns a class decorator that makes a protocol known by name."""
    return PROTOCOLS.register(name, name=name)


def known_protocols() -> List[Protocol]:
    """Returns the registered protocols, sorted by name."""
    return [protocol() for protocol in PROTOCOLS.values()]


def protocol_named(name: str) -> Protocol:
    """Returns the protocol of that name. Raises ParameterError with the nearest name."""
    return PROTOCOLS.find(name)()


def check_count(count: int, most: int) -> None:
    """Raises ParameterError: a protocol does not have that many starts."""
    if not 1 <= count <= most:
        raise ParameterError(f"starts: found {count}, allowed 1 to {most}")


def spread(count: int, total: int) -> List[int]:
    """Returns `count` of `total` indices, as evenly as possible, both ends included. Raises ParameterError."""
    check_count(count, total)
    return [0] if count == 1 else [round(i * (total - 1) / (count - 1)) for i in range(count)]


def halton(count: int) -> np.ndarray:
    """Returns a Halton sequence without its first point, which covers the unit square evenly, (count, 2)."""
    from scipy.stats import qmc  # slow to import
    return qmc.Halton(2, scramble=False).fast_forward(1).random(count)


def success_map(rows: List[Dict[str, Any]], axes: Tuple[str, str],
                edges: Sequence[np.ndarray]) -> Tuple[np.ndarray, np.ndarray]:
    """Returns (runs, successes) by cell of two columns of the rows, (nx, ny) each; `edges` are those of the cells."""
    x, y = (np.clip(np.array([row[axis] for row in rows], dtype=float), edge[0], edge[-1])
            for axis, edge in zip(axes, edges))
    won = np.array([row["success"] == 1 for row in rows], dtype=float)
    return (np.histogram2d(x, y, bins=list(edges))[0].astype(int),
            np.histogram2d(x, y, bins=list(edges), weights=won)[0].astype(int))


def with_picture(scenario: Scenario, path: Path) -> Scenario:
    """Returns the scenario with another picture, a file, on each of its flat models."""
    models = [{**model, "image": {**model["image"], "file": str(path.resolve())}}
              for model in scenario.sim["scene"]["models"]]
    return scenario.with_overrides({"sim.scene.models": models})
