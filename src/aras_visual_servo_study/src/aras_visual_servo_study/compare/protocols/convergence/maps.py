"""Pictures of the protocol `map`: one of the features of image areas, one of those of points and lines.

A block is a set of features with a map for each of its laws. Blocks stand side by side as they fit.
"""

from textwrap import wrap
from typing import Any, List, NamedTuple, Sequence, Tuple

import numpy as np

from .entries import Entry, of_laws_and_sets
from .sets import SETS

#: Of a picture, by its part of the file name: what it shows.
PICTURES = {"areas": "features of image areas", "points": "features of points and lines"}
#: Maps in a line, and dots per inch: 1800 pixels across, of which a page shows every other one.
COLUMNS, DPI = 9, 200
#: Sizes [inch]: of the picture, of the room left of the maps, of a map and its neighbours, of a line of text.
WIDTH_IN, LEFT_IN, STEP_IN, MAP_IN, TEXT_IN = 9.0, 0.5, 0.93, 0.74, 0.14
#: ... above a map for law and success, below it, for the numbers of its axis, for the scale of colours above all maps,
#: and below all of them.
ABOVE_IN, BELOW_IN, NUMBERS_IN, SCALE_IN, BOTTOM_IN = 0.29, 0.1, 0.14, 0.62, 0.38
#: Points of letters, and how many of them are an inch wide.
POINTS, LETTERS_PER_IN = 7.5, 14.5


class Block(NamedTuple):
    """A set of features, or a part of one that is longer than a line. column: of its first map."""

    label: str
    maps: Tuple[Entry, ...]
    column: int

    def words(self) -> List[str]:
        """The label in lines that are no wider than the maps."""
        return wrap(self.label, int(LETTERS_PER_IN * (STEP_IN * len(self.maps) - 0.1)))


def shown_in(made: Sequence[Entry], picture: str) -> List[Entry]:
    """The maps of one of PICTURES. A set of features that is not known here is one of points."""
    areas = {one.label for one in SETS if one.of_area}
    return [one for one in made if (one.features in areas) == (picture == "areas")]


def lines_of(made: Sequence[Entry]) -> List[List[Block]]:
    """Lines of blocks. The longest blocks come first, and each is put into the first line that has room for it."""
    _, sets, places = of_laws_and_sets(made)
    parts: List[Tuple[str, Tuple[Entry, ...]]] = []
    for label in sets:
        mine = tuple(one for (_, features), one in places.items() if features == label)
        parts += [(label, mine[at:at + COLUMNS]) for at in range(0, len(mine), COLUMNS)]
    lines: List[List[Block]] = []
    for label, maps in sorted(parts, key=lambda part: -len(part[1])):
        fits = (line for line in lines if line[-1].column + len(line[-1].maps) + len(maps) <= COLUMNS)
        line = next(fits, None)
        if line is None:
            line = []
            lines.append(line)
        line.append(Block(label, maps, line[-1].column + len(line[-1].maps) if line else 0))
    return lines


def make_figure(made: Sequence[Entry], title: str) -> Any:
    """A picture of these maps as a matplotlib Figure."""
    import matplotlib  # slow to import
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    from ....report.figure import STYLE
    lines = lines_of(made)
    lowest = {block.column + k: number for number, line in enumerate(lines) for block in line
              for k in range(len(block.maps))}
    below = [BELOW_IN + NUMBERS_IN * (number in lowest.values()) for number in range(len(lines))]
    heights = [TEXT_IN * max(len(block.words()) for block in line) + ABOVE_IN + MAP_IN + room
               for line, room in zip(lines, below)]
    height = SCALE_IN + sum(heights) + BOTTOM_IN
    letters = {"font.size": POINTS, "xtick.labelsize": POINTS, "ytick.labelsize": POINTS}
    with matplotlib.rc_context(dict(STYLE, **letters)):
        figure = Figure(figsize=(WIDTH_IN, height))

        def place(left, top, wide, tall):
            """Fractions of the figure of a box [inch], top counted from above."""
            return left / WIDTH_IN, 1.0 - (top + tall) / height, wide / WIDTH_IN, tall / height

        def write(left, top, text, **looks):
            figure.text(left / WIDTH_IN, 1.0 - top / height, text, **looks)

        scale = figure.add_axes(place(LEFT_IN, 0.1, 2.0, 0.13))
        figure.colorbar(ScalarMappable(Normalize(0.0, 100.0), "RdYlBu"), cax=scale, orientation="horizontal",
                        ticks=(0, 50, 100))
        write(LEFT_IN + 2.15, 0.16, f"success [%] from starts in a cell; {title}", va="center", fontweight="bold")
        write(LEFT_IN + 2.15, 0.31, "above a map: law, its success [%] and the 95 % interval", va="center")
        top = SCALE_IN
        for number, (line, tall, room) in enumerate(zip(lines, heights, below)):
            for block in line:
                left, wide = LEFT_IN + STEP_IN * block.column, STEP_IN * (len(block.maps) - 1) + MAP_IN
                write(left, top, "\n".join(block.words()), va="top", fontweight="bold", fontsize=POINTS + 0.5,
                      linespacing=1.05)
                figure.add_artist(matplotlib.lines.Line2D(
                    [left / WIDTH_IN, (left + wide) / WIDTH_IN], [1.0 - (top - 0.03) / height] * 2, color="#8c8c8c",
                    linewidth=0.7))
                for k, one in enumerate(block.maps):
                    column = block.column + k
                    panel = figure.add_axes(place(LEFT_IN + STEP_IN * column, top + tall - room - MAP_IN, MAP_IN,
                                                  MAP_IN))
                    _draw(panel, one, across=lowest[column] == number, up=column == 0)
            top += tall
        write(LEFT_IN + 0.5 * STEP_IN * COLUMNS, height - 0.1, "distance of the start from the goal [mm]", ha="center",
              va="center")
        write(0.09, SCALE_IN + 0.5 * sum(heights), "rotation of the start [deg]", ha="center", va="center", rotation=90)
    return figure


def _draw(panel, one, across, up):
    """Draws a map. across, up: whether the axes have numbers."""
    panel.grid(False)
    rate = np.divide(one.map.won, one.map.runs, out=np.full(one.map.runs.shape, np.nan), where=one.map.runs > 0)
    panel.pcolormesh(1e3 * one.map.edges_m, np.degrees(one.map.edges_rad), np.ma.masked_invalid(rate.T), cmap="RdYlBu",
                     vmin=0.0, vmax=1.0, rasterized=True)
    panel.set_title(f"{one.law}\n{one.rate()}", fontsize=POINTS, pad=2.5, linespacing=1.12, y=1.0, loc="left")
    panel.set_xticks([0.0, 1e3 * one.map.edges_m[-1]], None if across else ["", ""])
    panel.set_yticks([0, 90, 180], None if up else ["", "", ""])
    panel.tick_params(length=2.0, pad=1.5)
