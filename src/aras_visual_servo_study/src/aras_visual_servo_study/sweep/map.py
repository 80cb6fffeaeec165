"""What the maps of a page need to know of a sweep: a dot for each start, its result, and the command that repeats it.

The script web/map.js draws them.
"""

import json
from typing import Any, Dict, List, Mapping, Optional, Tuple

from aras_visual_servo import ArasError, palette
from ..report.joint_units import shown_units
from ..report.scales import read_off
from .figure import LABELS, known_axes
from .statistics import every_run_succeeds
from .worker import scenario_of

#: Looks of the outcomes of a run.
OUTCOMES = {"success": {"label": "success", "color": palette.BLUE},
            "failure": {"label": "failure", "color": palette.VERMILION},
            "error": {"label": "error", "color": "#7a1f1f"},
            "infeasible": {"label": "start refused", "color": palette.GREY, "cross": True}}
#: (column, label, unit, digits) of a run's result.
RESULTS = (("duration_s", "time", "s", 3), ("error_mm", "final error", "mm", 4), ("angle_deg", "final angle", "deg", 4),
           ("path_mm", "length of the path", "mm", 1), ("border_px", "nearest to the image border", "px", 1),
           ("joint_room", "room of the joints", "", 2))
#: Modules of the folder web that draw the maps, each after those that it imports.
MAP_MODULES = ("lib/dom.js", "lib/draw.js", "map.js")
#: Digits of a number in the page: more than a map can show.
SIGNIFICANT = 7


#: Beginnings of the columns of what was varied, and how a page calls them.
VARIED = {"start_": "start, ", "offset_": "offset, ", "goal_": "goal, ", "p_": ""}


def joint_units(setup: Dict[str, Any]) -> Dict[str, str]:
    """{joint: "m" or "rad"} of the robot of a sweep; {} where its files are not here any more."""
    try:
        units = shown_units(scenario_of(setup).urdf_xml())
    except (ArasError, OSError, RuntimeError, KeyError):
        return {}
    return {name: "m" if unit == "mm" else "rad" for name, (_, unit) in units.items()}


def sweep_maps(rows: List[Dict[str, Any]], axes: Tuple[str, ...], folder: Optional[str] = None,
               joints: Mapping[str, str] = {}) -> str:
    """The data of a sweep's maps, as JSON that may stand in a page; axes: the two columns to begin with.

    Args:
        folder: of the sweep, for the command that repeats a run; None: where the page is.
        joints: of `joint_units`.
    """
    success: Dict[str, Any] = {"title": "result", "key": "outcome", "kind": "classes", "classes": OUTCOMES}
    time = {"title": "time of successful runs [s]", "key": "succeeded_s", "kind": "scale"}
    error = {"title": "final error [mm]", "key": "error_mm", "kind": "scale"}
    rows = [dict(row, succeeded_s=row["duration_s"] if row["success"] else None) for row in rows]
    facts = [fact("outcome", "result", short=True), fact("reason", "reason", short=True), fact("detail", "in words"),
             *(fact(key, label, unit, digits, short=key in ("duration_s", "error_mm"))
               for key, label, unit, digits in RESULTS), *start_facts(rows, joints)]
    command: Dict[str, Any] = {"label": "Rerun with the full report:", "folder": folder,
                               "text": "aras-servo rerun {id} --sweep {folder}"}
    maps = [time, error] if every_run_succeeds(rows) else [success, time, error]
    return page_data(rows, axes, maps, facts, [command], {"key": "outcome", "value": "infeasible"}, joints)


def fact(key: str, label: str, unit: str = "", digits: Optional[int] = None, short: bool = False) -> Dict[str, Any]:
    """What a page tells of a run. short: also where the pointer only passes."""
    return {"key": key, "label": label, "unit": unit, "digits": digits, "short": short}


def varied(column: str, joints: Mapping[str, str]) -> Optional[Tuple[str, float, str]]:
    """(name, factor, unit) of a column of something that was varied, as people read it; None for other columns."""
    for beginning, words in VARIED.items():
        if column.startswith(beginning) and column not in LABELS and not column.endswith("_mm"):
            name = column[len(beginning):]
            read, factor, unit = read_off(name, joints.get(name, "") if beginning == "start_" else "")
            return words + read, factor, unit
    return None


def start_facts(rows: List[Dict[str, Any]], joints: Mapping[str, str] = {}) -> List[Dict[str, Any]]:
    """Facts of where a run begins: its place against the goal, then the joints and whatever else was varied."""
    found = [fact(axis, plain_label(axis).partition(" [")[0], unit, digits, axis in ("distance0_mm", "angle0_deg"))
             for axis, unit, digits in (("distance0_mm", "mm", 1), ("angle0_deg", "deg", 2), ("x0_mm", "mm", 2),
                                        ("y0_mm", "mm", 2), ("z0_mm", "mm", 2))]
    for column in rows[0] if rows else ():
        read = varied(column, joints)
        if read:
            numbers = all(isinstance(row[column], (float, type(None))) for row in rows)
            found.append(fact(column, read[0], read[2], (2 if read[2] in ("mm", "deg") else 4) if numbers else None))
    return found


def page_data(rows: List[Dict[str, Any]], axes: Tuple[str, ...], maps: List[Dict[str, Any]],
              facts: List[Dict[str, Any]], commands: List[Dict[str, Any]], crosses: Optional[Dict[str, str]],
              joints: Mapping[str, str] = {}) -> str:
    """JSON of rows (dicts), maps, facts and commands. A text that many rows share stands there once.

    Args:
        crosses: {key, value} of rows that a map shows as crosses where it has no value for them.
        joints: of `joint_units`.
    """
    read = {key: varied(key, joints) or (key, 1.0, "") for key in (rows[0] if rows else ())}
    offered = list(dict.fromkeys([*known_axes(rows), *axes]))
    keys = list(dict.fromkeys([*offered, *(one["key"] for one in maps), "id",
                               *(one["key"] for one in facts)]))
    keys = [key for key in keys if rows and key in rows[0]]
    texts = {key: list(dict.fromkeys(row[key] for row in rows if isinstance(row[key], str))) for key in keys}
    texts = {key: found for key, found in texts.items() if found}
    place = {key: {text: i for i, text in enumerate(found)} for key, found in texts.items()}

    def cell(row, key):
        value = row[key]
        if key in place:
            return place[key].get(value)
        return float(f"{read[key][1] * value:.{SIGNIFICANT}g}") if isinstance(value, float) else value

    data = {"columns": keys, "rows": [[cell(row, key) for key in keys] for row in rows], "texts": texts,
            "axes": [{"key": axis, "label": plain_label(axis, joints)} for axis in offered], "x": axes[0],
            "y": axes[1], "maps": maps, "facts": [one for one in facts if one["key"] in keys], "commands": commands,
            "crosses": crosses}
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")


def plain_label(axis: str, joints: Mapping[str, str] = {}) -> str:
    """Name of an axis without mathtext."""
    name, _, unit = varied(axis, joints) or (LABELS.get(axis, axis).replace("$", ""), 1.0, "")
    return f"{name} [{unit}]" if unit else name
