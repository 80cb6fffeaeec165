"""Units in which pages show positions of joints."""

import math
from typing import Dict, Iterable, Tuple

from ..live.view.robot import robot_of


def shown_units(urdf_xml: str) -> Dict[str, Tuple[float, str]]:
    """Returns (factor, unit) by joint, from m to mm for those that slide and from rad to degrees for the others."""
    return {joint["name"]: (1e3, "mm") if joint["type"] == "prismatic" else (180.0 / math.pi, "deg")
            for joint in robot_of(urdf_xml)["joints"]}


def units_text(units: Iterable[str]) -> str:
    """Returns the different units, for the axis of a plot of several joints."""
    return ", ".join(sorted(set(units), reverse=True))
