"""Computes the settling times of a servo run from its feature errors."""

from typing import Dict

import numpy as np

from aras_visual_servo import RunRecord, spread

#: An error has settled when it stays within this part of its size at the start, or within its threshold.
SETTLED_PART = 0.05


def settling_times_s(record: RunRecord) -> Dict[str, float]:
    """Returns feature name -> time from the first servo image until its error stays in the band [s].

    The band of a feature is the larger of SETTLED_PART of its error at the start and its threshold of the stop rule. The
    times are interpolated between images. NaN: the error is outside of the band at the end.
    """
    rows = record.servo_rows
    thresholds = spread(record.settings.get("servo", {}).get("thresholds", {}))
    t_s = 1e-9 * (record.stamp_ns[rows] - record.stamp_ns[rows[0]]) if len(rows) else np.zeros(0)
    return {name: _settled_s(t_s, np.abs(record.e[rows, column]), float(thresholds.get(name, 0.0)))
            for column, name in enumerate(record.feature_names)}


def settling_s(record: RunRecord) -> float:
    """Returns the time until every feature has settled [s]; NaN if one has not."""
    return float(np.max(list(settling_times_s(record).values())))


def _settled_s(t_s, size, threshold):
    seen = np.isfinite(size)
    t_s, size = t_s[seen], size[seen]
    if not len(size):
        return float("nan")
    band = max(SETTLED_PART * size[0], threshold)
    outside = np.flatnonzero(size > band)
    if not len(outside):
        return 0.0
    last = int(outside[-1])
    if last + 1 == len(size):
        return float("nan")
    return float(np.interp(-band, -size[last:last + 2], t_s[last:last + 2]))
