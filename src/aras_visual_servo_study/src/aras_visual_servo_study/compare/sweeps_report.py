"""Page of a comparison of sweeps: the numbers of each, the statistics of the pairs, and maps of what changed where."""

import math

from aras_visual_servo import palette
from ..report.report import ResultFolderError
from ..report.template import render, source
from ..report.versions import installed_versions
from ..sweep.figure import AXES, DEFAULT_AXES
from ..sweep.map import fact, page_data, start_facts, sweep_maps
from .sweeps import LETTERS, PAIRED, TABLE, numbers_of, pair, table_cells

FILE = "compare.html"
#: A test's result counts as a difference below this p-value.
SIGNIFICANT_P = 0.05


def save_sweeps_page(names, folders, sweeps, gates, folder, command):
    """Write compare.html. Returns its path.

    Args:
        names: of the sweeps.  folders: absolute paths of their folders.  sweeps: rows of each, A first.
        gates: [(expression, whether it fires, why)].  folder: existing folder to write to.
        command: how to repeat the comparison.
    Raises:
        ResultFolderError: the file cannot be written.
    """
    path = folder / FILE
    try:
        path.write_text(sweeps_page(names, folders, sweeps, gates, command), encoding="utf-8")
    except OSError as error:
        raise ResultFolderError(f"{path}: cannot be written: {error.strerror}") from error
    return path


def sweeps_page(names, folders, sweeps, gates, command):
    """The page as text; arguments as of `save_sweeps_page`."""
    letters = LETTERS[:len(sweeps)]
    numbers = numbers_of(sweeps)
    first = {"maps": sweep_maps(sweeps[0], DEFAULT_AXES, str(folders[0]))} if len(sweeps) == 1 else None
    pairs = [{"title": f"{letter}: {name} against A: {names[0]}", "words": _words(letter, numbers),
              "maps": paired_maps(sweeps[0], rows, letter, (str(folders[0]), str(folder)))}
             for letter, name, folder, rows in list(zip(letters, names, folders, sweeps))[1:]]
    return render("sweeps.html.j2", sweeps=list(zip(letters, names, map(str, folders))),
                  table=table_cells(TABLE, numbers, letters),
                  paired=table_cells(PAIRED, numbers, letters[1:]) if pairs else [], pairs=pairs, first=first,
                  gates=gates, command=command, versions=installed_versions(), script=source("map.js"))


def paired_maps(rows_a, rows_b, letter, folders):
    """Data of the maps of sweep B, called `letter`, against A: JSON for the page. A dot is a pair of runs."""
    rows = [_pair_row(a, b) for a, b in pair(rows_a, rows_b)]
    looks = {"both": ("both succeed", palette.BLUE), "neither": ("neither", palette.GREY),
             "only_a": ("only A", palette.VERMILION), "only_b": (f"only {letter}", palette.GREEN)}
    classes = {key: {"label": label, "color": color} for key, (label, color) in looks.items()}
    alike = all(row["pair"] == "both" for row in rows)
    maps = [] if alike else [{"title": "who succeeds", "key": "pair", "kind": "classes", "classes": classes}]
    maps += [{"title": f"change of the time, {letter} − A [s], where both succeed", "key": "time_change_s",
              "kind": "change"},
             {"title": f"change of the final error, {letter} − A [mm], where both succeed", "key": "error_change_mm",
              "kind": "change"}]
    facts = [fact(f"{key}_{which}", f"{label}, {name}", unit, digits, short=key in ("reason", "duration_s"))
             for key, label, unit, digits in (("outcome", "result", "", None), ("reason", "reason", "", None),
                                              ("duration_s", "time", "s", 3), ("error_mm", "final error", "mm", 4))
             for which, name in (("a", "A"), ("b", letter))] + start_facts(rows)
    commands = [{"label": f"Run it again in {name}:", "folder": folder,
                 "text": "rosrun aras_visual_servo_controller rerun {id} --sweep {folder}"}
                for name, folder in zip(("A", letter), folders)]
    return page_data(rows, DEFAULT_AXES, maps, facts, commands, None)


def _pair_row(a, b):
    row = {name: value for name, value in a.items()
           if name == "id" or name in AXES or name.startswith(("start_", "offset_", "goal_", "p_"))}
    for which, one in (("a", a), ("b", b)):
        row.update({f"{key}_{which}": one[key] for key in ("outcome", "reason", "duration_s", "error_mm")})
    both = bool(a["success"]) and bool(b["success"])
    row["pair"] = "both" if both else "only_a" if a["success"] else "only_b" if b["success"] else "neither"
    row["time_change_s"] = b["duration_s"] - a["duration_s"] if both else None
    row["error_change_mm"] = b["error_mm"] - a["error_mm"] if both else None
    return row


def _words(letter, numbers):
    """What the tests say of a sweep against A, a list of sentences."""
    def of(name):
        return numbers[f"{letter}.{name}"]

    def clear(p):
        return "no clear difference" if p >= SIGNIFICANT_P else "a difference that is hardly chance"

    if not of("pairs"):
        return ["No start was run by both."]
    words = [f"Of {of('pairs'):.0f} starts, A alone succeeds on {of('only_a'):.0f} and {letter} alone on "
             f"{of('only_b'):.0f}: {clear(of('mcnemar_p'))} (McNemar, p = {of('mcnemar_p'):.3g})."]
    for name, unit, digits, what in (("time", "s", 3, "time"), ("error", "mm", 4, "final error")):
        change, p = of(f"{name}_change_{unit}"), of(f"{name}_p")
        if not math.isnan(change):
            less = f"{abs(change):.{digits}f} {unit} {'less' if change < 0 else 'more'}" if change else "no change"
            words.append(f"The {what} of {letter}, in the median of the pairs: {less}; {clear(p)} (Wilcoxon, "
                         f"p = {p:.3g}).")
    return words
