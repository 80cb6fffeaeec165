"""The picture of docs/tutorial.md: the error of xn in experiment_1 with gain 3 /s and with gain 1 /s."""
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import aras_visual_servo as avs
from aras_visual_servo import load_scenario

GAINS_PER_S = (3.0, 1.0)
COLOURS = ("#0072b2", "#d55e00")


def curve(gain_per_s):
    """(t_s, e): time since the servo began, and the error of xn [m] until it is within a threshold of zero."""
    record = avs.run(load_scenario("experiment_1", {"servo.gains_per_s.xn": gain_per_s}))
    rows = record.servo_rows
    return record.t_s[rows] - record.t_s[rows[0]], np.abs(record.e[rows, record.feature_names.index("xn")])


def save_picture(path):
    """Write the picture, PNG."""
    figure = Figure(figsize=(6.4, 3.2), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(xlabel="time since the servo began [s]", ylabel="error of xn [mm]", yscale="log")
    for gain, colour in zip(GAINS_PER_S, COLOURS):
        t_s, e = curve(gain)
        axes.plot(t_s, 1e3 * e, color=colour, label=f"gain {gain:g} /s")
        axes.plot(t_s, 1e3 * e[0] * np.exp(-gain * t_s), color=colour, linestyle=":", linewidth=1)
    axes.axhline(0.05, color="0.5", linewidth=1)
    axes.text(5.0, 0.055, "threshold", color="0.4", ha="center", va="bottom")
    axes.set_ylim(0.005, 300.0)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, metadata={"Software": None})
