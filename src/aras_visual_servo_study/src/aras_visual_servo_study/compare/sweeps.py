"""Compares sweeps run by run on the same starts: numbers of each, statistics of the pairs, gates (conditions on these
numbers), and a page with maps of what changed where."""

import ast
import math
import operator
import statistics
from pathlib import Path
from typing import Any, Dict, List, Mapping, Sequence, Tuple, Union

from aras_visual_servo import ParameterError, palette
from ..files import write_whole
from ..report.template import render, script
from ..report.versions import installed_versions
from ..sweep.figure import AXES, default_axes
from ..sweep.judge import COLUMNS
from ..sweep.map import MAP_MODULES, fact, page_data, start_facts, sweep_maps
from ..sweep.metrics import known_metrics
from ..sweep.statistics import aggregate, mcnemar, signed_rank

FILE = "compare.html"
#: A test's result counts as a difference below this p-value.
SIGNIFICANT_P = 0.05
#: What pairs of successful runs are compared by: name, column of the sweep, unit, digits, in words.
CHANGES = (("time", "duration_s", "s", 3, "time"), ("error", "error_mm", "mm", 4, "final error"),
           ("angle", "angle_deg", "deg", 5, "final angle"))
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def pair(rows_a: List[Dict[str, Any]], rows_b: List[Dict[str, Any]]) -> List[Tuple[Dict[str, Any], Dict[str, Any]]]:
    """Pairs of feasible runs of two sweeps: list of (row, row).

    Raises: ParameterError: a run has another start in one sweep than in the other, so there are no pairs.
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
    mcnemar_p, time_change_s, time_p, error_change_mm, error_p, angle_change_deg and angle_p.

    Success is compared by McNemar's test. The other CHANGES are compared over the pairs where both runs succeeded, by
    Wilcoxon's signed-rank test; a change is the median of B - A.
    """
    pairs = pair(rows_a, rows_b)
    only_a = sum(bool(a["success"]) and not b["success"] for a, b in pairs)
    only_b = sum(bool(b["success"]) and not a["success"] for a, b in pairs)
    result = {"pairs": len(pairs), "only_a": only_a, "only_b": only_b,
              "success_change": (only_b - only_a) / len(pairs) if pairs else math.nan,
              "mcnemar_p": mcnemar(only_a, only_b)}
    both = [(a, b) for a, b in pairs if a["success"] and b["success"]]
    for name, column, unit, _, _ in CHANGES:
        a, b = [x[column] for x, _ in both], [x[column] for _, x in both]
        result[f"{name}_change_{unit}"] = statistics.median(y - x for x, y in zip(a, b)) if both else math.nan
        result[f"{name}_p"] = signed_rank(a, b)
    return result


def numbers_of(sweeps: List[List[Dict[str, Any]]]) -> Dict[str, float]:
    """Every number a gate may name: `A.success` and so on, A first, and those of the last sweep also without letter."""
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
    Returns: (fires, predicate of a sentence about the expression: "holds (success = 0.85)"). A gate also fires if one
        of its names has no value, for example because no run succeeded.
    Raises: ParameterError: this is no such expression, or a name is unknown; the known ones are listed.
    """
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError) as error:
        raise ParameterError(f"--fail-if '{expression}': not an expression such as success<0.98") from error
    used = {}
    value = _evaluate(tree.body, numbers, used, expression)
    if not isinstance(value, bool):
        raise ParameterError(f"--fail-if '{expression}': found a number, allowed a comparison such as success<0.98")
    without = [name for name, number in used.items() if math.isnan(number)]
    if without:
        return True, f"has no value, because {', '.join(without)} has none"
    numbers_used = ", ".join(f"{name} = {number:.6g}" for name, number in used.items())
    return value, ("holds" if value else "does not hold") + (f" ({numbers_used})" if used else "")


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
        raise ParameterError(f"--fail-if '{expression}': found {name}, allowed {', '.join(known)}; each also "
                             f"with the letter of a sweep before it ({', '.join(letters)}), e.g. A.success")
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
          *(row for name, _, unit, digits, _ in CHANGES
            for row in ((f"  {name} change [{unit}]", f"{name}_change_{unit}", f"{{:+.{digits}f}}"),
                        (f"  Wilcoxon p, {name}", f"{name}_p", "{:.3g}"))))


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
    for letter, name in list(zip(letters, names))[1:]:
        lines += ["", _pair_title(letter, name, names), *(f"  {sentence}" for sentence in _words(letter, numbers))]
    return "\n".join(lines)


def _pair_title(letter, name, names):
    return f"{letter}: {name} against A: {names[0]}"


def _start(row):
    return {name: value for name, value in row.items()
            if name.startswith(("start_", "offset_", "goal_")) and name not in COLUMNS}


def save_sweeps_page(names: Sequence[str], folders: Sequence[Union[str, Path]], sweeps: List[List[Dict[str, Any]]],
                     gates: Sequence[Tuple[str, bool, str]], folder: Path, command: str,
                     joints: Mapping[str, str] = {}, missing: Sequence[str] = ()) -> Path:
    """Writes compare.html into an existing folder. Returns its path.

    Args: folders: absolute paths of those of the sweeps.  sweeps: rows of each, A first.
        gates: [(expression, whether it fires, predicate)] of `gate_fires`.  command: how to repeat the comparison.
        joints: of `joint_units`.  missing: sentences about sweeps that are not complete.
    Raises: ResultFolderError: the file cannot be written.
    """
    return write_whole(folder / FILE, sweeps_page(names, folders, sweeps, gates, command, joints, missing))


def sweeps_page(names: Sequence[str], folders: Sequence[Union[str, Path]], sweeps: List[List[Dict[str, Any]]],
                gates: Sequence[Tuple[str, bool, str]], command: str, joints: Mapping[str, str] = {},
                missing: Sequence[str] = ()) -> str:
    """The page as text; arguments as of `save_sweeps_page`."""
    letters = LETTERS[:len(sweeps)]
    numbers = numbers_of(sweeps)
    first = None
    if len(sweeps) == 1:
        first = {"maps": sweep_maps(sweeps[0], default_axes(sweeps[0]), str(folders[0]), joints)}
    pairs = [{"title": _pair_title(letter, name, names), "words": _words(letter, numbers),
              "maps": paired_maps(sweeps[0], rows, letter, (str(folders[0]), str(folder)), joints)}
             for letter, name, folder, rows in list(zip(letters, names, folders, sweeps))[1:]]
    return render("sweeps.html.j2", sweeps=list(zip(letters, names, map(str, folders))),
                  table=table_cells(TABLE, numbers, letters),
                  paired=table_cells(PAIRED, numbers, letters[1:]) if pairs else [], pairs=pairs, first=first,
                  gates=gates, missing=missing, command=command, versions=installed_versions(),
                  script=script(*MAP_MODULES))


def paired_maps(rows_a: List[Dict[str, Any]], rows_b: List[Dict[str, Any]], letter: str,
                folders: Tuple[str, str], joints: Mapping[str, str] = {}) -> str:
    """Data of the maps of sweep B, called `letter`, against A: JSON for the page. A dot is a pair of runs."""
    rows = [_pair_row(a, b) for a, b in pair(rows_a, rows_b)]
    looks = {"both": ("both succeed", palette.BLUE), "neither": ("neither", palette.GREY),
             "only_a": ("only A", palette.VERMILION), "only_b": (f"only {letter}", palette.GREEN)}
    classes = {key: {"label": label, "color": color} for key, (label, color) in looks.items()}
    alike = all(row["pair"] == "both" for row in rows)
    maps = [] if alike else [{"title": "success by sweep", "key": "pair", "kind": "classes", "classes": classes}]
    maps += [{"title": f"change of the {what}, {letter} − A [{unit}], where both succeed",
              "key": f"{name}_change_{unit}", "kind": "change"} for name, _, unit, _, what in CHANGES]
    facts = [fact(f"{key}_{which}", f"{label}, {name}", unit, digits, short=key in ("reason", "duration_s"))
             for key, label, unit, digits in (("outcome", "result", "", None), ("reason", "reason", "", None),
                                              *((column, what, unit, digits)
                                                for _, column, unit, digits, what in CHANGES))
             for which, name in (("a", "A"), ("b", letter))] + start_facts(rows, joints)
    commands = [{"label": f"Rerun in {name}:", "folder": folder,
                 "text": "aras-servo rerun {id} --sweep {folder}"}
                for name, folder in zip(("A", letter), folders)]
    return page_data(rows, default_axes(rows, "duration_s_a"), maps, facts, commands, None, joints)


def _pair_row(a, b):
    columns = {column: f"{name}_change_{unit}" for name, column, unit, _, _ in CHANGES}
    row = {name: value for name, value in a.items()
           if name == "id" or name in AXES or name.startswith(("start_", "offset_", "goal_", "p_"))}
    for which, one in (("a", a), ("b", b)):
        row.update({f"{key}_{which}": one[key] for key in ("outcome", "reason", *columns)})
    both = bool(a["success"]) and bool(b["success"])
    row["pair"] = "both" if both else "only_a" if a["success"] else "only_b" if b["success"] else "neither"
    row.update({change: b[column] - a[column] if both else None for column, change in columns.items()})
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
    for name, _, unit, digits, what in CHANGES:
        change, p = of(f"{name}_change_{unit}"), of(f"{name}_p")
        if not math.isnan(change):
            less = f"{abs(change):.{digits}f} {unit} {'less' if change < 0 else 'more'}" if change else "no change"
            words.append(f"The {what} of {letter}, in the median of the pairs: {less}; {clear(p)} (Wilcoxon, "
                         f"p = {p:.3g}).")
    return words
