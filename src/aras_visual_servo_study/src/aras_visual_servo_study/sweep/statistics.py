"""Statistics of sweeps. All are pure functions of rows; the tests hold them against published tables."""

import math
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np

from .metrics import known_metrics

#: Two-sided 95 % of the normal distribution.
Z_95 = 1.959963984540054

#: Differences of pairs are told apart to so many decimals of s, mm and degrees.
DECIMALS = 9
#: The exact distribution of tied ranks is used for so many pairs at most.
MOST_EXACT = 50


def every_run_succeeds(rows: List[Dict[str, Any]]) -> bool:
    """Whether there are runs whose start was not refused, and all of them succeeded: a map of the result would have one
    colour."""
    tried = [row["success"] for row in rows if row["outcome"] != "infeasible"]
    return bool(tried) and all(tried)


def wilson(successes: int, count: int, z: float = Z_95) -> Tuple[float, float]:
    """Wilson's score interval of a proportion.

    Args: successes, count: whole numbers, 0 <= successes <= count.  z: quantile, default 95 % two-sided.
    Returns: (low, high) in [0, 1]; (0, 1) for count 0.
    Reference: Wilson, JASA 22(158), 1927, 209-212.
    """
    if count == 0:
        return 0.0, 1.0
    p, square = successes / count, z * z / count
    middle = (p + square / 2.0) / (1.0 + square)
    half = z / (1.0 + square) * math.sqrt(p * (1.0 - p) / count + square / (4.0 * count))
    # For no success the lower bound is exactly 0, for nothing but successes the upper one is 1; rounding would miss it.
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == count else middle + half)


def mcnemar(only_a: int, only_b: int) -> float:
    """Exact two-sided p-value of the hypothesis that two methods succeed equally often; 1 if there are no pairs.

    Args: only_a, only_b: number of pairs where only A, only B succeeded.
    Reference: McNemar, Psychometrika 12(2), 1947; the exact form is a sign test.
    """
    from scipy.stats import binomtest
    total = only_a + only_b
    return float(binomtest(only_a, total, 0.5).pvalue) if total else 1.0


def signed_rank(a: Sequence[float], b: Sequence[float]) -> float:
    """Two-sided p-value of Wilcoxon's signed-rank test; 1 if all pairs are equal, NaN if there are none.

    Pairs without a difference are left out before scipy chooses the method: with them it takes the normal approximation
    even for few pairs. Differences are rounded, so that equal ones are ties. scipy's exact table has no half ranks:
    with it the value of few tied pairs would depend on which of both is a.
    """
    from scipy.stats import rankdata, wilcoxon
    difference = np.round(np.asarray(a, dtype=float) - np.asarray(b, dtype=float), DECIMALS)
    if not len(difference):
        return math.nan
    difference = difference[difference != 0.0]
    size = np.abs(difference)
    if len(difference) > MOST_EXACT or len(np.unique(size)) == len(difference) > 0:
        return float(wilcoxon(difference).pvalue)
    # The number of signs that give each sum of doubled ranks.
    doubled = np.round(2.0 * rankdata(size)).astype(int) if len(difference) else np.zeros(0, dtype=int)
    ways = np.zeros(doubled.sum() + 1)
    ways[0] = 1.0
    for rank in doubled:
        ways[rank:] = ways[rank:] + ways[:len(ways) - rank]
    up = doubled[difference > 0.0].sum()
    return min(1.0, 2.0 * float(min(ways[:up + 1].sum(), ways[up:].sum()) / ways.sum()))


def success_curve(distances: Any, successes: Any, bins: int = 8) -> List[Dict[str, float]]:
    """Success rate against distance, in bins of equal width.

    Args: distances: (n,).  successes: (n,) 0 or 1.
    Returns: list of dict low, high, middle, count, rate, ci_low, ci_high; empty bins are left out.
    """
    distances, successes = np.array(distances, dtype=float), np.array(successes, dtype=float)
    if not len(distances):
        return []
    edges = np.linspace(distances.min(), distances.max(), bins + 1)
    which = np.clip(np.searchsorted(edges, distances, side="right") - 1, 0, bins - 1)
    curve = []
    for i in range(bins):
        inside = which == i
        count, wins = int(inside.sum()), int(successes[inside].sum())
        if count:
            low, high = wilson(wins, count)
            curve.append({"low": float(edges[i]), "high": float(edges[i + 1]), "count": count, "rate": wins / count,
                          "middle": float(distances[inside].mean()), "ci_low": low, "ci_high": high})
    return curve


def aggregate(rows: List[Dict[str, Any]]) -> Dict[str, float]:
    """Numbers of a sweep by name. Infeasible starts are counted in `runs` and `infeasible` and left out of the rest.

    Rates, one of each metric, are those of the feasible runs of which it says something; times and errors are those of
    the runs that succeeded; a number is NaN if there are no such runs.
    """
    feasible = [row for row in rows if row["outcome"] != "infeasible"]
    won = [row for row in feasible if row["success"]]
    total = len(feasible)
    numbers = {
        "runs": len(rows), "feasible": total, "infeasible": len(rows) - total,
        "errors": sum(row["outcome"] == "error" for row in rows),
        "failures": sum(row["outcome"] == "failure" for row in rows),
    }
    for name in (*(metric.name for metric in known_metrics()), "converged"):
        said = [bool(row[name]) for row in feasible if row.get(name) is not None]
        numbers[name] = sum(said) / len(said) if said else math.nan
        low, high = wilson(sum(said), len(said))
        numbers[f"{name}_low"], numbers[f"{name}_high"] = low, high
    for name, column in (("time", "duration_s"), ("error", "error_mm"), ("angle", "angle_deg")):
        values = np.array([row[column] for row in won], dtype=float)
        unit = column.rpartition("_")[2]
        for part, value in (("median", 50), ("p95", 95), ("max", 100)):
            numbers[f"{name}_{part}_{unit}"] = float(np.percentile(values, value)) if len(values) else math.nan
    return numbers


def reasons(rows: List[Dict[str, Any]]) -> List[Tuple[str, str, List[int]]]:
    """(outcome, reason, ids) of the runs that did not succeed, the most frequent reason first."""
    ids: Dict[Tuple[str, str], List[int]] = {}
    for row in rows:
        if row["outcome"] != "success":
            ids.setdefault((row["outcome"], row["reason"]), []).append(row["id"])
    return [(*key, of_key) for key, of_key in sorted(ids.items(), key=lambda item: (-len(item[1]), item[0]))]
