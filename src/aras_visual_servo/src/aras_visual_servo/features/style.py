"""How features are shown: figures, pages, videos and tables give a feature the same unit, symbol and colour.

    for style, column in zip(styles(record.feature_names), record.e.T):
        axes.plot(t_s, style.factor * column, color=style.colour, label=style.mathtext)

The class of each feature has them; a plugin without gets defaults.
"""

import math
import re
from dataclasses import dataclass, replace
from typing import Iterable, Tuple

from .base import Feature, feature_class
from ..palette import LEAST_DISTANCE, distance, shade, spare

#: For a feature's unit: the factor to the unit in which people read it, and that unit.
_READ_OFF = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}


@dataclass(frozen=True)
class FeatureStyle:
    """How one feature is shown.

    Attributes:
        name: as in a scenario.  unit: "m", "rad", "grey", "-" for none.
        symbol: plain text, a subscript after the first underscore: "x_n", "α".
        label: short description.  colour: "#rrggbb".
    """

    name: str
    unit: str
    symbol: str
    label: str
    colour: str

    @property
    def letter(self) -> str:
        """The symbol without its subscript."""
        return self.symbol if self.symbol == self.name else self.symbol.partition("_")[0]

    @property
    def subscript(self) -> str:
        """The subscript of the symbol, "" if it has none."""
        return "" if self.symbol == self.name else self.symbol.partition("_")[2]

    @property
    def mathtext(self) -> str:
        """Symbol and `read_unit` as text for matplotlib: "$x_{n}$ [mm]"."""
        plain = re.fullmatch(r"\w+", self.symbol) and (self.subscript or len(self.letter) == 1)
        if not plain:  # mathtext would set a name of several letters as a product of variables
            return self.symbol.replace("$", r"\$") + f" [{self.read_unit}]"
        below = self.subscript.replace("_", r"\_")
        return (f"${self.letter}_{{{below}}}$" if below else f"${self.letter}$") + f" [{self.read_unit}]"

    @property
    def factor(self) -> float:
        """Factor from `unit` to `read_unit`."""
        return _READ_OFF.get(self.unit, (1.0, self.unit))[0]

    @property
    def read_unit(self) -> str:
        """The unit in which people read values off: mm for m, deg for rad, else `unit`."""
        return _READ_OFF.get(self.unit, (1.0, self.unit))[1]

    @property
    def column(self) -> str:
        """Name of a column of a table with values of this feature: "xn_m", "x1"."""
        unit = self.unit.replace("1/", "per_").replace("/", "_per_")
        return self.name if unit == "-" else f"{self.name}_{unit}"


def styles(names: Iterable[str]) -> Tuple[FeatureStyle, ...]:
    """Style of each of these features, shown together: no two have the same colour.

    Args:
        names: of features; an unregistered name, for example of a missing plugin, gets the defaults.
    Returns:
        tuple of FeatureStyle. A feature keeps its own colour unless one before it has nearly the same; then it gets a
        spare one, as does a feature without a colour of its own.
    """
    found = [_style(name) for name in names]
    kept, taken = [], []
    for style in found:
        keeps = bool(style.colour) and all(distance(style.colour, other) >= LEAST_DISTANCE for other in taken)
        kept.append(keeps)
        taken += [style.colour] * keeps
    for index, style in enumerate(found):
        if not kept[index]:
            found[index] = replace(style, colour=spare(taken))
            taken.append(found[index].colour)
    return tuple(found)


def _style(name):
    """The feature's own style; colour "" where it has none."""
    feature = feature_class(name) or Feature
    symbol, label = (text.replace("{number}", str(feature.number)) for text in (feature.symbol, feature.label))
    colour = feature.colour if isinstance(feature.colour, str) else shade(feature.colour, feature.number)
    return FeatureStyle(name, feature.unit, symbol or name, label or name, colour)
