"""Scales of plots whose curves have several units: lengths are read in mm on the left, angles in deg on the right.

A metre is drawn as high as a radian and as a number without unit, so that one place of zero serves all curves.
"""

import math
from typing import Iterable, List, NamedTuple, Optional, Tuple

DEG = 180.0 / math.pi
_LENGTHS = {"m": "mm", "m/s": "mm/s"}
_ANGLES = {"rad": "deg", "rad/s": "deg/s"}


class Scale(NamedTuple):
    """Numbers along an axis.  factor: from the unit in which a curve is given.  label: the units, "[mm]"."""

    factor: float
    label: str


#: The scales of curves that have no unit, or whose unit their label names.
NO_UNIT: Tuple[Scale, Optional[Scale]] = (Scale(1.0, ""), None)


def scales_of(units: Iterable[str]) -> Tuple[Scale, Optional[Scale]]:
    """The scales (left, right) of curves in these units; right is None where no angle stands beside something else.

    Args: units: as of `FeatureStyle.unit`, and those of velocities.
    """
    known = list(dict.fromkeys(units))
    angles = [_ANGLES[unit] for unit in known if unit in _ANGLES]
    others = [unit for unit in known if unit not in _ANGLES]
    if not others:
        return Scale(DEG, _label(angles)) if angles else Scale(1.0, ""), None
    in_mm = any(unit in _LENGTHS for unit in others)
    names = [_LENGTHS.get(unit, f"10⁻³ {unit}".replace(" -", "") if in_mm else unit) for unit in others]
    return Scale(1e3 if in_mm else 1.0, _label(names)), Scale(DEG, _label(angles)) if angles else None


def read_off(name: str, unit: str = "") -> Tuple[str, float, str]:
    """What people read of a number: (its name without unit, factor, unit of the product).

    Args: name: may end with the unit, as keys of a scenario do: "x_m".  unit: of a name that does not.
    """
    for known in ("m", "rad"):
        if name.endswith(f"_{known}"):
            name, unit = name[:-len(known) - 1], known
    if unit == "rad":
        return name, DEG, "deg"
    return (name, 1e3, "mm") if unit == "m" else (name, 1.0, unit)


def _label(names: List[str]) -> str:
    return ", ".join(f"[{name}]" for name in names)
