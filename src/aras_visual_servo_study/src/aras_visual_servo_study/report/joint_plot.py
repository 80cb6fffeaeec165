"""Plot of the joints between their limits, for the page. A joint without limits is drawn in half turns from zero."""

import math
from typing import Any, Dict, Optional

import numpy as np

from aras_visual_servo import ArasError, RunRecord, palette, scenario_from_dict
from .joint_units import shown_units
from .plots import series_of, time_plot

DASH = "6 3"  # of a joint without limits


def joint_plot(record: RunRecord) -> Optional[Dict[str, Any]]:
    """The plot, a dict as `plots` describes it; None for a record whose robot is not known here.

    A curve is -1 at the lower limit and 1 at the upper one. What is read off is the joint's position.
    """
    rows = record.servo_rows
    try:
        scenario = scenario_from_dict(record.settings)
        kinematics = scenario.kinematics(calibrated=False)
    except (ArasError, RuntimeError, KeyError, TypeError, AttributeError):  # a record of another place
        return None
    if not len(rows) or not set(kinematics.joint_names) <= set(record.joint_names):
        return None
    units = shown_units(scenario.urdf_xml())
    series = []
    for place, (name, low, high) in enumerate(zip(kinematics.joint_names, kinematics.lower, kinematics.upper)):
        limited = math.isfinite(low) and math.isfinite(high)
        factor, unit = units[name]
        half, middle = (0.5 * (high - low), 0.5 * (high + low)) if limited else (1.0 if unit == "mm" else math.pi, 0.0)
        q = record.q[rows, record.joint_names.index(name)]
        colour = palette.PALETTE[place % len(palette.PALETTE)]
        one = series_of((name, "", colour, "" if limited else DASH, factor * half, unit), (q - middle) / half)
        series.append(dict(one, offset=factor * middle))
    t_s = record.servo_t_s
    free = [one["name"] for one in series if one["dash"]]
    title = "joints between their limits" + (f" ({', '.join(free)}: no limits, in half turns)" if free else "")
    return time_plot("joints", title, np.asarray(t_s), series, "−1: lower limit, 1: upper limit", ends=[-1.0, 1.0])
