"""The page of an identified arm: its parameters, and measured against simulated joints. One self-contained file."""

import math
from typing import Dict, List, Sequence, Tuple

import numpy as np

from aras_visual_servo import palette
from .joint_units import units_text
from .plots import series_of, time_plot
from .template import render

#: Curves are drawn through so many points at most.
MOST_POINTS = 600
BLUE, RED = palette.BLUE, palette.VERMILION


def identified_html(title: str, command: str, joint_names: Sequence[str], times_s: np.ndarray, measured: np.ndarray,
                    simulated: np.ndarray, fitted: int, rows: List[Dict[str, str]], unknown: List[Dict[str, str]],
                    notes: Sequence[str], units: Dict[str, Tuple[float, str]]) -> str:
    """Returns the page.

    Args:
        times_s: (k,) from the first command on.  measured, simulated: (k, m) positions [m or rad].
        fitted: samples that were fitted; the others are held out.
        rows: name, value, interval and unit of each estimate, as texts.  unknown: name, others and motion.
        units: of `shown_units`, for the positions.
    """
    factors = np.array([units[name][0] for name in joint_names])
    measured, simulated = factors * measured, factors * simulated
    error, all_units = simulated - measured, units_text(units[name][1] for name in joint_names)
    fit, held = (np.sqrt(np.mean(part**2, axis=0)) for part in (error[:fitted], error[fitted:]))
    noise = np.sqrt(np.mean(np.diff(error[:fitted], axis=0)**2, axis=0) / 2.0)
    residuals = [{"name": f"{name} [{units[name][1]}]", "fit": f"{a:.3g}", "held": f"{b:.3g}", "noise": f"{c:.3g}"}
                 for name, a, b, c in zip(joint_names, fit, held, noise)]
    step = max(1, math.ceil(len(times_s) / MOST_POINTS))
    thin = slice(None, None, step)
    across = "time since the first command [s]"
    plots = [time_plot(f"joint_{i}", name, times_s[thin], [
        series_of(("measured", "", BLUE, "", 1.0, ""), measured[thin, i]),
        series_of(("simulated", "", RED, "5 4", 1.0, ""), simulated[thin, i])], units[name][1], across=across)
        for i, name in enumerate(joint_names)]
    colours = [palette.PALETTE[i % len(palette.PALETTE)] for i in range(len(joint_names))]
    plots.append(time_plot("residual", "simulated minus measured", times_s[thin], [
        series_of((name, "", colour, "", 1.0, ""), error[thin, i])
        for i, (name, colour) in enumerate(zip(joint_names, colours))], all_units, across=across))
    hertz, density = _spectrum(times_s, error)
    densities = ", ".join(f"{unit}/√Hz" for unit in all_units.split(", "))
    plots.append(time_plot("spectrum", "spectrum of the residual, flat for noise alone", hertz, [
        series_of((name, "", colour, "", 1.0, ""), density[:, i])
        for i, (name, colour) in enumerate(zip(joint_names, colours))], densities, log=True,
        across="frequency [Hz]"))
    return render("identified.html.j2", title=title, command=command, rows=rows, unknown=unknown, notes=list(notes),
                  residuals=residuals, plots=plots, held_from=f"{times_s[fitted]:.1f}" if fitted < len(times_s) else "")


def _spectrum(times_s, error):
    """(frequencies [Hz], amplitude densities): mean of Hann windows that overlap by half (Welch, 1967)."""
    period = float(np.median(np.diff(times_s)))
    length = min(256, len(error) // 2 * 2)
    window = np.hanning(length + 2)[1:-1][:, None]
    parts = [np.abs(np.fft.rfft((error[at:at + length] - error[at:at + length].mean(axis=0)) * window, axis=0))**2
             for at in range(0, len(error) - length + 1, length // 2)]
    density = np.mean(parts, axis=0) * 2.0 * period / np.sum(window**2)
    return np.fft.rfftfreq(length, period)[1:], np.sqrt(density)[1:]
