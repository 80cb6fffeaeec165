"""Rows of the tables that every report shows, as text."""

import math
from typing import Any, Dict, List, Optional

from .scales import DEG

#: Stands below each table that shows the published results.
NOT_COMPARABLE = ("The paper's row cannot be compared with the others: the paper does not define its \"mean of "
                  "tracking errors\" (of which quantity, against which truth, over how many runs).")
#: Columns of the table of final errors.
ERROR_KEYS = ("x_mm", "y_mm", "z_mm", "angle_deg")
#: What the stop rule judges beside the features: key, label, unit that is shown, its factor.
_STOP = (("tilt_rad", "tilt", "deg", DEG), ("position_m", "distance from the goal", "mm", 1e3),
         ("rotation_rad", "angle from the goal", "deg", DEG))


def comparison_rows(summary: Dict[str, Any]) -> List[Dict[str, Any]]:
    """Rows of the table of final errors: dicts of label, kind ("ours", "limit", "paper", "start") and cells (text)."""
    rows = [{"label": "this run", "kind": "ours",
             "cells": [_signed(summary["final_error"], key) for key in ERROR_KEYS]}]
    if summary["judge"]:
        rows.append({"label": "allowed (experiment.judge)", "kind": "limit",
                     "cells": [f"{summary['judge'][key]:g}" for key in ERROR_KEYS]})
    if summary["published"]:
        rows.append({"label": summary["published"]["label"], "kind": "paper",
                     "cells": [f"{summary['published'][key]:g}" for key in ERROR_KEYS]})
    rows.append({"label": "at the start of the servo", "kind": "start",
                 "cells": [_signed(summary["initial_error"], key) for key in ERROR_KEYS]})
    return rows


def stop_rows(summary: Dict[str, Any]) -> List[Dict[str, str]]:
    """Rows of what the stop rule judged beside the features: dicts of label, found and allowed, as text.

    The published rule judges nothing beside them, so it has none.
    """
    stop, rows = summary.get("stop") or {}, []
    if stop.get("rule") != "pose":
        return []
    for key, label, unit, factor in _STOP:
        found = stop.get(key, {}).get("found")
        if is_number(found):
            allowed = stop[key]["allowed"]
            rows.append({"label": label, "found": f"{found * factor:.3g} {unit}",
                         "allowed": f"{allowed * factor:.3g} {unit}"})
    return rows


def _signed(error, key):
    value = error[key]
    if not is_number(value):
        return "unknown"
    if key == "angle_deg":
        return f"{value:.4f}" if value < 1.0 else f"{value:.2f}"
    return f"{value:+.3f}" if abs(value) < 10.0 else f"{value:+.1f}"


def is_number(value: Optional[float]) -> bool:
    """Whether the value exists and is finite."""
    return value is not None and math.isfinite(value)
