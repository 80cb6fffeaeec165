"""The page docs/performance.md and its pictures, from what growth.py measured.

A series is (title, what is counted, unit of the cost, counts, costs), all of them by name.
"""
import textwrap
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from aras_visual_servo_study.report.figure import STYLE

#: A series bends where one more costs this many times what it cost before.
BEND = 1.5
INTRODUCTION = """
What a frame costs, how the cost grows, and where it bends. `script/bench --growth` measures all of it and writes this
page and its pictures; nothing here is typed by hand. `script/bench` measures us beside other programs, and
`script/test counts` counts instructions, so that no change makes a piece of work slower unseen.
"""
METHODS = """
**Processor time, not the clock.** A figure in us is the time that one thread spent, the least of {repetitions}
repetitions, so that other programs on the machine change it little.

**In process** is experiment_1 from its first image to its end, 30 images and 1000 physics steps a simulated second,
with a 320 x 240 rgb8 camera and the whole record. The parts are timed at the doors between them, in a run of their
own, because the clock costs time too.

**Over ROS** two runs with their bags are compared, of which one servos 200 s longer: what each process used more
until its bag was closed, over the images more. So starting, importing and the report do not count.

**Arms** are generated chains, every joint with a PID controller. **Scenes** are those of `script/bench`: a table that
fills the view, and a flat target on it.

**Workers** are processes that are busy as long as a run takes on a core of its own, by sleeping: so a cluster of eight
cores can be simulated on fewer, and what is measured is how far handing out and saving runs keeps up.
"""


class Measured(NamedTuple):
    """Everything that the page tells.

    Attributes:
        series: list of (title, what is counted, unit of the cost, counts, costs).  sizes: (width, height) -> (render,
        features) [us].  workers: number -> runs a second.  frames: title -> {part: us a frame}.
        whole_us: a frame in process, without clocks between the parts.  machine: what it was measured on.
        repetitions: of each figure.
    """

    series: list
    sizes: dict
    workers: dict
    frames: dict
    whole_us: float
    machine: str
    repetitions: int


def digits(value):
    """A number with three digits that count, as text: 0.0123, 1.23, 12300."""
    return f"{float(f'{value:.3g}'):g}"


def slopes(counts, costs):
    """What one more costs, from each point to the next."""
    return [(b - a) / (n - m) for m, n, a, b in zip(counts, counts[1:], costs, costs[1:])]


def bend(counts, costs):
    """The first of the counts beyond which one more costs over BEND times what it cost on average up to there.

    None if there is none. The first step is no measure for those that follow: it is as small as what it is part of.
    """
    for at in range(2, len(counts) - 1):
        before = (costs[at] - costs[0]) / (counts[at] - counts[0])
        after = (costs[at + 1] - costs[at]) / (counts[at + 1] - counts[at])
        if after > BEND * before and after > 0.0:
            return counts[at]
    return None


def series_text(title, what, unit, counts, costs):
    """Lines of a section."""
    lines = [f"### {title}", "", f"| {what} | {unit} | one more |", "|---|---|---|"]
    more = ["", *(f"{digits(slope)}" for slope in slopes(counts, costs))]
    lines += [f"| {n} | {digits(cost)} | {extra} |" for n, cost, extra in zip(counts, costs, more)]
    at = bend(counts, costs)
    lines += ["", f"It bends at {at} {what}: beyond, one more costs over {BEND:g} times what it did up to there." if at
              else f"It does not bend: one more never costs over {BEND:g} times what it did before."]
    return lines


def draw_growth(measured, path):
    """The picture of all series."""
    sizes, workers = measured.sizes, measured.workers
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 6.0), constrained_layout=True)
        panels = figure.subplots(2, 4).flat
        for _, what, unit, counts, costs in measured.series:
            panel = next(panels)
            panel.plot(counts, costs, "o-", markersize=4)
            panel.set(xlabel=what, ylabel=unit.partition(",")[0])
            panel.set(**{"xscale": "log", "yscale": "log"} if max(counts) > 1000 else {"ylim": (0.0, None)})
            if bend(counts, costs):
                panel.axvline(bend(counts, costs), linestyle=":", color="#888888")
        panel = next(panels)
        pixels = [1e-6 * width * height for width, height in sizes]
        for part, label in enumerate(("render", "features")):
            panel.plot(pixels, [cost[part] for cost in sizes.values()], "o-", markersize=4, label=label)
        panel.set(xlabel="megapixels", ylabel="us an image", ylim=(0.0, None))
        panel.legend()
        panel = next(panels)
        panel.plot(list(workers), list(workers.values()), "o-", markersize=4, label="measured")
        first = next(iter(workers.values()))
        panel.plot(list(workers), [first * n for n in workers], ":", color="#888888", label="n times one")
        panel.set(xlabel="workers, simulated", ylabel="runs / s", ylim=(0.0, None))
        panel.legend()
        for panel in panels:
            panel.set_axis_off()
        figure.savefig(path, dpi=110, metadata={"Software": None})


def draw_budget(frames, path):
    """The picture of where a frame goes."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 0.6 + 0.9 * len(frames)), constrained_layout=True)
        for panel, (title, parts) in zip(np.atleast_1d(figure.subplots(len(frames), 1)), frames.items()):
            left = 0.0
            for k, (part, us) in enumerate(sorted(parts.items(), key=lambda item: -item[1])):
                panel.barh([0], [us], left=left, color=matplotlib.cm.tab10(k % 10), label=f"{part} {us:.0f}")
                left += us
            panel.set_title(f"{title}, {left:.0f} us of processor time a frame", loc="left")
            panel.set_yticks([])
            panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5, handlelength=1.0)
        figure.savefig(path, dpi=110, metadata={"Software": None})


def filled(text, bullet=""):
    """The lines of a paragraph."""
    return textwrap.wrap(" ".join(text.split()), 125, initial_indent=bullet, subsequent_indent=" " * len(bullet))


def page(measured):
    """Text of docs/performance.md."""
    sizes, workers, frames, whole_us = measured.sizes, measured.workers, measured.frames, measured.whole_us
    lines = ["# Performance", "", *filled(INTRODUCTION), "", f"Measured on {measured.machine}.", "",
             "## How each figure is taken", ""]
    for entry in METHODS.format(repetitions=measured.repetitions).strip().split("\n\n"):
        lines += filled(entry, "- ")
    lines += ["", "## Where a frame goes", "", "![Budget of a frame](images/frame_budget.png)", ""]
    for title, parts in frames.items():
        lines += [f"| {title} | us a frame |", "|---|---|",
                  *(f"| {part} | {us:.0f} |" for part, us in sorted(parts.items(), key=lambda item: -item[1])),
                  f"| sum | {sum(parts.values()):.0f} |", ""]
    lines += [f"Without clocks between the parts a frame in process costs {whole_us:.0f} us: "
              f"{1e6 / 30.0 / whole_us:.0f} times real time.", "",
              "## How it grows", "", "![Growth](images/growth.png)", ""]
    for one in measured.series:
        lines += series_text(*one) + [""]
    lines += ["### Image size", "", "| image | render [us] | features [us] | both, ns a pixel |", "|---|---|---|---|"]
    lines += [f"| {width} x {height} | {digits(render)} | {digits(features)} | "
              f"{digits(1e3 * (render + features) / (width * height))} |"
              for (width, height), (render, features) in sizes.items()]
    pixels, sums = [width * height for width, height in sizes], [sum(cost) for cost in sizes.values()]
    at = bend(pixels, sums)
    lines += ["", "It bends at %d x %d: beyond, a pixel more costs over %g times what it did up to there." %
              (*list(sizes)[pixels.index(at)], BEND) if at else
              f"It does not bend: one more pixel never costs over {BEND:g} times what it did before.", "",
              "### Workers of a sweep", "", "| workers | runs / s | of what as many as one would do |", "|---|---|---|"]
    first = next(iter(workers.values()))
    lines += [f"| {n} | {digits(rate)} | {100 * rate / (n * first):.0f} % |" for n, rate in workers.items()]
    late = [n for n, rate in workers.items() if rate < 0.9 * n * first]
    lines += ["", f"It bends at {late[0]} workers: fewer than 90 % of what as many workers could do." if late else
              "It does not bend: every worker adds at least 90 % of what one does alone."]
    return "\n".join(lines) + "\n"
