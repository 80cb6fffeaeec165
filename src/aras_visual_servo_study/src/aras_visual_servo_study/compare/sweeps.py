"""Compares sweeps run by run on the same starts, and evaluates gates: conditions on their numbers."""

import ast
import math
import operator
from typing import Any, Dict, List, Sequence, Tuple

from aras_visual_servo import ParameterError
from ..sweep.judge import COLUMNS
from ..sweep.metrics import known_metrics
from ..sweep.statistics import aggregate, mcnemar, signed_rank

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def pair(rows_a: List[Dict[str, Any]], rows_b: List[Dict[str, Any]]) -> List[Tuple[Dict[str, Any], Dict[str, Any]]]:
    """Pairs of feasible runs of two sweeps: list of (row, row).

    Raises:
        ParameterError: a run has another start in one sweep than in the other, so there are no pairs.
    """
    by_id = {row["id"]: row for row in rows_b}
    pairs = []
    for a in rows_a:
        b = by_id.get(a["id"])
        if b is None:
            continue
        if _start(a) != _start(b):
            raise ParameterError(f"run {a['id']}: the starts differ; compare sweeps of the same scenario geometry, "
                                 "method, ranges, --starts and --seed")
        if "infeasible" not in (a["outcome"], b["outcome"]):
            pairs.append((a, b))
    return pairs


def compare_pair(rows_a: List[Dict[str, Any]], rows_b: List[Dict[str, Any]]) -> Dict[str, float]:
    """Paired statistics of sweep B against A: dict of pairs, only_a, only_b, success_change,
    mcnemar_p, time_change_s, time_p, error_change_mm and error_p.

    Success is compared by McNemar's test. Time and error are compared over the pairs where both runs succeeded, by
    Wilcoxon's signed-rank test; their change is the median of B - A.
    """
    pairs = pair(rows_a, rows_b)
    only_a = sum(bool(a["success"]) and not b["success"] for a, b in pairs)
    only_b = sum(bool(b["success"]) and not a["success"] for a, b in pairs)
    result = {"pairs": len(pairs), "only_a": only_a, "only_b": only_b,
              "success_change": (only_b - only_a) / len(pairs) if pairs else math.nan,
              "mcnemar_p": mcnemar(only_a, only_b)}
    both = [(a, b) for a, b in pairs if a["success"] and b["success"]]
    for name, column, unit in (("time", "duration_s", "s"), ("error", "error_mm", "mm")):
        a, b = [x[column] for x, _ in both], [x[column] for _, x in both]
        changes = sorted(y - x for x, y in zip(a, b))
        middle = len(changes) // 2
        result[f"{name}_change_{unit}"] = (math.nan if not changes else changes[middle] if len(changes) % 2
                                           else 0.5 * (changes[middle - 1] + changes[middle]))
        result[f"{name}_p"] = signed_rank(a, b)
    return result


def numbers_of(sweeps: List[List[Dict[str, Any]]]) -> Dict[str, float]:
    """Every number a gate may name.

    Args:
        sweeps: list of rows (list of dicts) per sweep, A first.
    Returns:
        dict: `A.success` and so on for each sweep, and for the last one the same names without a letter too.
    """
    numbers = {}
    for letter, rows in zip(LETTERS, sweeps):
        mine = aggregate(rows)
        if rows is not sweeps[0]:
            mine.update(compare_pair(sweeps[0], rows))
        numbers.update({f"{letter}.{name}": value for name, value in mine.items()})
        if rows is sweeps[-1]:
            numbers.update(mine)
    return numbers


def gate_fires(expression: str, numbers: Dict[str, float]) -> Tuple[bool, str]:
    """Whether a gate such as "success<0.98 or B.time_median_s > 1.1*A.time_median_s" fires.

    An expression may contain numbers, names, + - * /, comparisons, and, or, not, brackets, and nothing else.

    Returns:
        (fires, why). A gate also fires if one of its names has no value, for example because no run succeeded.
    Raises:
        ParameterError: this is no such expression, or a name is unknown; the known ones are listed.
    """
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError) as error:
        raise ParameterError(f"--fail-if '{expression}': not an expression such as success<0.98") from error
    used = {}
    value = _evaluate(tree.body, numbers, used, expression)
    if not isinstance(value, bool):
        raise ParameterError(f"--fail-if '{expression}': found a number, allowed is a comparison such as success<0.98")
    why = ", ".join(f"{name} = {number:.6g}" for name, number in used.items())
    without = [name for name, number in used.items() if math.isnan(number)]
    return (True, f"no value: {', '.join(without)}") if without else (value, why)


_ARITHMETIC = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
_COMPARISONS = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
                ast.Eq: operator.eq, ast.NotEq: operator.ne}


def _evaluate(node, numbers, used, expression):
    def value_of(child, kind):
        value = _evaluate(child, numbers, used, expression)
        if isinstance(value, bool) != (kind is bool):
            raise ParameterError(f"--fail-if '{expression}': found a {'comparison' if kind is float else 'number'} "
                                 f"where a {'number' if kind is float else 'comparison'} must stand")
        return value

    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return float(node.value)
    if isinstance(node, (ast.Name, ast.Attribute)):
        return _lookup(ast.unparse(node), numbers, used, expression)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -value_of(node.operand, float)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        return not value_of(node.operand, bool)
    if isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        left, right = value_of(node.left, float), value_of(node.right, float)
        try:
            return float(_ARITHMETIC[type(node.op)](left, right))
        except ZeroDivisionError:
            raise ParameterError(f"--fail-if '{expression}': divides by zero") from None
    if isinstance(node, ast.BoolOp):
        values = [value_of(child, bool) for child in node.values]  # all of them, so that `used` is complete
        return all(values) if isinstance(node.op, ast.And) else any(values)
    if isinstance(node, ast.Compare) and all(type(op) in _COMPARISONS for op in node.ops):
        values = [value_of(child, float) for child in [node.left] + node.comparators]
        return all(_COMPARISONS[type(op)](x, y) for op, x, y in zip(node.ops, values, values[1:]))
    raise ParameterError(f"--fail-if '{expression}': allowed are numbers, names, + - * /, comparisons, and, or, not")


def _lookup(name, numbers, used, expression):
    if name not in numbers:
        known = [other for other in numbers if "." not in other]
        letters = sorted({other.partition(".")[0] for other in numbers if "." in other})
        raise ParameterError(f"--fail-if '{expression}': unknown name '{name}', known are {', '.join(known)}; each "
                             f"also with the letter of a sweep before it ({', '.join(letters)}), e.g. A.success")
    used[name] = float(numbers[name])
    return used[name]


#: Rows of the table of a comparison: label, number, format.
TABLE = (("runs", "runs", "{:.0f}"), ("infeasible starts", "infeasible", "{:.0f}"), ("errors", "errors", "{:.0f}"),
         ("success", "success", "{:.4f}"), ("  95 % from", "success_low", "{:.4f}"), ("  to", "success_high", "{:.4f}"),
         *((metric.label, metric.name, "{:.4f}") for metric in known_metrics()[1:]),
         ("converged", "converged", "{:.4f}"), ("time, median [s]", "time_median_s", "{:.3f}"),
         ("time, 95 % [s]", "time_p95_s", "{:.3f}"), ("error, median [mm]", "error_median_mm", "{:.4f}"),
         ("error, 95 % [mm]", "error_p95_mm", "{:.4f}"), ("angle, median [deg]", "angle_median_deg", "{:.5f}"))
#: ... and of the statistics of pairs.
PAIRED = (("  pairs", "pairs", "{:.0f}"), ("  only A succeeds", "only_a", "{:.0f}"),
          ("  only this succeeds", "only_b", "{:.0f}"), ("  McNemar p", "mcnemar_p", "{:.3g}"),
          ("  time change [s]", "time_change_s", "{:+.3f}"), ("  Wilcoxon p, time", "time_p", "{:.3g}"),
          ("  error change [mm]", "error_change_mm", "{:+.4f}"), ("  Wilcoxon p, error", "error_p", "{:.3g}"))


def table_cells(rows: Sequence[Tuple[str, str, str]], numbers: Dict[str, float],
                letters: Sequence[str]) -> List[Tuple[str, List[str]]]:
    """[(label, [text per sweep])] of TABLE or PAIRED: "" for a number that a sweep does not have, "-" for NaN."""
    found = [[numbers.get(f"{letter}.{name}") for letter in letters] for _, name, _ in rows]
    return [(label, ["" if value is None else "-" if math.isnan(value) else form.format(value) for value in values])
            for (label, _, form), values in zip(rows, found)]


def format_comparison(names: Sequence[str], sweeps: List[List[Dict[str, Any]]]) -> str:
    """The comparison as a table for the terminal, str."""
    numbers, letters = numbers_of(sweeps), LETTERS[:len(sweeps)]
    width = max(12, *(len(name) + 4 for name in names))
    lines = ["".ljust(26) + "".join(f"{letter}: {name}".rjust(width) for letter, name in zip(letters, names))]
    for rows in (TABLE, PAIRED) if len(sweeps) > 1 else (TABLE,):
        lines += ["against A, same starts"] if rows is PAIRED else []
        lines += [label.ljust(26) + "".join(cell.rjust(width) for cell in cells)
                  for label, cells in table_cells(rows, numbers, letters)]
    return "\n".join(lines)


def _start(row):
    return {name: value for name, value in row.items()
            if name.startswith(("start_", "offset_", "goal_")) and name not in COLUMNS}
