"""The page of a calibration: values, residuals beside what noise lets expect, and the result. One whole file."""

from typing import Any, Dict, List, Sequence, Tuple

from .template import render


def calibration_html(title: str, command: str, values: Sequence[Any], unknown: Sequence[Tuple[str, str]],
                     views: Sequence[Tuple[str, float]], residual_px: float, expected_px: float, verdict: str,
                     fits: bool, cost: Dict[str, float], cost_unit: str, document: str) -> str:
    """Returns the page.

    Args:
        values: estimates with name, value, stddev and unit.  unknown: (name, reason).  views: (name, residual [px]).
        verdict: what the residual says.  fits: whether noise explains it.  cost: text -> value at the goal.
        document: text of the file that the calibration made.
    """
    most = max([expected_px, *(each for _, each in views)])
    rows: List[Dict[str, Any]] = [{"name": name, "residual": f"{each:.3f}", "part": f"{100 * each / most:.1f}"}
                                  for name, each in views]
    return render("calibration.html.j2", title=title, command=command, verdict=verdict, fits=fits, document=document,
                  residual=f"{residual_px:.3f}", expected=f"{expected_px:.3f}", count=len(views), views=rows,
                  expected_part=f"{100 * expected_px / most:.1f}",
                  values=[{"name": each.name, "cells": [f"{each.value:.6g}", f"{each.stddev:.2g}", each.unit]}
                          for each in values],
                  unknown=[{"name": name, "cells": [reason]} for name, reason in unknown], cost_unit=cost_unit,
                  cost=[{"name": name, "cells": [f"{value:.3g}"]} for name, value in cost.items()])
