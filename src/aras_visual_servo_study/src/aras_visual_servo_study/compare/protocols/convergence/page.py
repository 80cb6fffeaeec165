"""The page of the protocol `map`: every map side by side, sets of features down and laws across, and what can be
promised of its cells."""

import base64
from pathlib import Path
from typing import Any, Dict, List, Tuple

from ....files import write_whole
from ....report.template import render
from ....report.versions import installed_versions
from ..base import Case
from ..runner import markdown_table
from .entries import Entry, entries, of_laws_and_sets
from .maps import DPI, PICTURES, make_figure, shown_in

PAGE, PICTURE, TABLE = "map.html", "map_{}.png", "map.md"


def save(results: List[Tuple[Case, List[Dict[str, Any]]]], left_out: List[Tuple[str, str]], folder: Path) -> List[Path]:
    """Writes PAGE, a PICTURE for each of `maps.PICTURES` that has maps, and TABLE into the folder. Returns their paths.

    Args: results: list of (Case, rows).  left_out: list of (what is not mapped, why).
    Raises: ResultFolderError: a file cannot be written.
    """
    made = entries(results)
    pictures = save_pictures(made, folder)
    laws, sets, places = of_laws_and_sets(made)
    grid = [(label, [places.get((law, label)) for law in laws]) for label in sets]
    page = write_whole(folder / PAGE, render(
        "convergence.html.j2", grid=grid, laws=laws, entries=made, left_out=left_out, versions=installed_versions(),
        pictures=[(title, base64.b64encode(path.read_bytes()).decode("ascii")) for title, path in pictures]))
    return [page, *(path for _, path in pictures), write_whole(folder / TABLE, as_markdown(made))]


def save_pictures(made: List[Entry], folder: Path) -> List[Tuple[str, Path]]:
    """Writes the pictures. Returns [(title, path)]."""
    written = []
    for name, title in PICTURES.items():
        shown, path = shown_in(made, name), folder / PICTURE.format(name)
        if shown:
            make_figure(shown, title).savefig(path, dpi=DPI, metadata={"Software": None})
            written.append((title, path))
    return written


def as_markdown(made: List[Entry]) -> str:
    """The success rates in percent with their intervals as a table, sets of features down and laws across."""
    laws, sets, places = of_laws_and_sets(made)
    return markdown_table([["features", *(f"`{law}`" for law in laws)], *(
        [label, *(places[law, label].rate() if (law, label) in places else "" for law in laws)] for label in sets)])
