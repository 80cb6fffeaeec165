"""Computes the settling times of a servo run from its feature errors."""

from typing import Dict

import numpy as np

from aras_visual_servo import RunRecord, spread

#: An error has settled when it stays within this part of its size at the start, or within its threshold.
SETTLED_PART = 0.05


def error_size(record: RunRecord) -> np.ndarray:
    """Returns the root mean square of the errors in units of their thresholds, (j,), at the servo images."""
    thresholds = spread(record.settings.get("servo", {}).get("thresholds", {}))
    unit = np.array([thresholds.get(name, 1.0) for name in record.feature_names])
    return np.sqrt(np.mean((record.e[record.servo_rows] / unit)**2, axis=1))


def settling_s(record: RunRecord) -> float:
    """Returns the time from the first servo image until the errors stay in their band [s].

    Their size is that of `error_size`; the band is the larger of SETTLED_PART of the size at the start and 1. The time
    is interpolated between images. NaN: the size is outside of the band at the end.
    """
    return _settled_s(record.servo_t_s, error_size(record), 1.0)


def settling_times_s(record: RunRecord) -> Dict[str, float]:
    """Returns feature name -> time as of `settling_s` of its error alone [s]; the band is at least its threshold."""
    thresholds = spread(record.settings.get("servo", {}).get("thresholds", {}))
    return {name: _settled_s(record.servo_t_s, np.abs(record.e[record.servo_rows, column]),
                             float(thresholds.get(name, 0.0)))
            for column, name in enumerate(record.feature_names)}


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
