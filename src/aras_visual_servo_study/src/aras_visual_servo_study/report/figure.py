"""The six panels of the paper's figure, drawn from a RunRecord with matplotlib, without pyplot and a display.

(a) desired image  (b) initial image  (c) differences from the desired image, at the start and at the end
(d) feature errors  (e) camera velocity  (f) path of the camera in the world, circle at the start, star at the goal.
Lengths are in mm and angles in deg.
"""

import contextlib
import io
from pathlib import Path
from typing import Any, List, Optional, Tuple

import matplotlib
import numpy as np
from fontTools import subset
from matplotlib.axes import Axes
from matplotlib.backends import _backend_pdf_ps
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D

from aras_visual_servo import RunRecord, palette, styles
from ..files import write_whole
from .pictures import DIFFERENCES, LARGEST, PANELS, image_of, largest_difference, panel_title
from .scales import Scale, scales_of

#: Panels of the figure, in two rows: panel (c) is the difference at the start with that at the end beside it.
IMAGES, PLOTS = ("desired", "initial", "start", "difference"), ("errors", "velocity", "path")
TWIST_LABELS = ("$v_x$", "$v_y$", "$v_z$", r"$\omega_x$", r"$\omega_y$", r"$\omega_z$")
TWIST_STYLES = tuple((color, style) for style in ("-", (0, (4, 1.5)))
                     for color in (palette.BLUE, palette.VERMILION, palette.GREEN))

STYLE = {
    "font.family": "DejaVu Sans", "mathtext.fontset": "dejavusans", "font.size": 9.0, "axes.titlesize": 9.5,
    "axes.labelsize": 9.0, "legend.fontsize": 8.5, "xtick.labelsize": 8.5, "ytick.labelsize": 8.5,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#444444", "axes.linewidth": 0.8,
    "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.7, "axes.axisbelow": True,
    "lines.linewidth": 1.5, "legend.frameon": False, "pdf.fonttype": 42, "svg.hashsalt": "aras_visual_servo",
}


def _letters_of(fontfile, characters):
    """A font with these characters alone, for the PDF: a stream. It is what matplotlib makes, but without the tables by
    which a text is set (ligatures, kerning): no reader of a PDF looks at them, and to reduce them takes longer than to
    draw the figure."""
    options = subset.Options(glyph_names=True, recommended_glyphs=True)
    options.drop_tables += ["FFTM", "PfEd", "BDF", "GDEF", "GPOS", "GSUB"]
    if fontfile.endswith(".ttc"):
        options.font_number = 0
    with subset.load_font(fontfile, options) as font:
        subsetter = subset.Subsetter(options=options)
        subsetter.populate(text=characters)
        subsetter.subset(font)
        stream = io.BytesIO()
        font.save(stream, reorderTables=False)
        return stream


@contextlib.contextmanager
def _lean_fonts():
    """Within it a PDF has the fonts of `_letters_of`. Which function matplotlib calls for them is not promised: a
    version that calls another one, and those since 3.9, whose function returns a font, go on with their own."""
    if hasattr(_backend_pdf_ps, "font_as_file"):
        yield
        return
    before = getattr(_backend_pdf_ps, "get_glyphs_subset", None)
    _backend_pdf_ps.get_glyphs_subset = _letters_of
    try:
        yield
    finally:
        _backend_pdf_ps.get_glyphs_subset = before


def save_figure(record: RunRecord, png_path: Optional[Path] = None, pdf_path: Optional[Path] = None,
                dpi: int = 160) -> None:
    """Write the six panels as one picture, 3 x 2.

    Args: record: RunRecord.  png_path, pdf_path: files to write; None: not this one.
    """
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 6.0))
        images = figure.add_gridspec(1, 4, left=0.03, right=0.945, top=0.95, bottom=0.63, wspace=0.08)
        plots = figure.add_gridspec(1, 3, left=0.065, right=0.975, top=0.55, bottom=0.08, wspace=0.53)
        for column, panel in enumerate(IMAGES):
            draw_panel(record, panel, figure.add_subplot(images[column]), letter="abc"[column:column + 1],
                       scale=panel == IMAGES[-1])
        for column, panel in enumerate(PLOTS):
            axes = figure.add_subplot(plots[column], projection=Axes3D.name if panel == "path" else None)
            if panel == "path":  # the names of its axes stand right of it
                left, bottom, width, height = axes.get_position().bounds
                axes.set_position((left - 0.02, bottom - 0.03, width, height + 0.05))
            draw_panel(record, panel, axes, letter="def"[column])
        # Without a creation date the same run gives the same bytes.
        if png_path is not None:
            figure.savefig(png_path, dpi=dpi, metadata={"Software": None})
        if pdf_path is not None:
            with _lean_fonts():
                figure.savefig(pdf_path, metadata={"CreationDate": None})


def save_both(figure: Figure, path: Path, dpi: int = 110) -> bytes:
    """Writes PATH.png and PATH.pdf, without a date: the same figure gives the same bytes. Returns those of the PNG.

    Raises: ResultFolderError: a file cannot be written.
    """
    files = {}
    with matplotlib.rc_context(STYLE):
        for kind, metadata in (("png", {"Software": None}), ("pdf", {"CreationDate": None})):
            stream = io.BytesIO()
            figure.savefig(stream, format=kind, dpi=dpi if kind == "png" else "figure", metadata=metadata)
            files[kind] = stream.getvalue()
            write_whole(path.with_suffix(f".{kind}"), files[kind])
    return files["png"]


def save_panels(record: RunRecord, folder: Path, size_in: Tuple[float, float] = (3.5, 2.7)) -> List[Path]:
    """Write each of the six panels as FOLDER/panel_NAME.pdf, of the width of a column of a paper, without title.

    Returns: list of the paths.
    """
    paths = []
    with matplotlib.rc_context(STYLE):
        for panel in PANELS:
            figure = Figure(figsize=size_in, constrained_layout=panel != "path")
            axes = figure.add_subplot(projection=Axes3D.name if panel == "path" else None)
            draw_panel(record, panel, axes, title=False)
            if panel == "path":
                figure.subplots_adjust(left=0.0, right=0.9, bottom=0.08, top=1.0)
            paths.append(folder / f"panel_{panel}.pdf")
            figure.savefig(paths[-1], metadata={"CreationDate": None})
    return paths


def draw_panel(record: RunRecord, panel: str, axes: Axes, letter: str = "", title: bool = True,
               scale: bool = True) -> None:
    """Draws one of PANELS, or "start" (see `image_of`), on matplotlib axes; "path" needs a 3-D projection.

    Args: scale: whether a difference has its scale of grey levels beside it.
    """
    if panel not in (*PANELS, "start"):
        raise ValueError(f"panel '{panel}': allowed are {', '.join(PANELS)}, start")
    if title:
        # With a place given, matplotlib does not measure every label to find one: a third of the time of drawing.
        axes.set_title((f"({letter}) " if letter else "") + panel_title(record, panel), pad=5.0,
                       y=None if panel == "path" else 1.0)
    if panel == "errors":
        shown = styles(record.feature_names)
        looks: List[Any] = [(style.colour, "-", style.mathtext) for style in shown]
        _draw_curves(record, axes, record.e, looks, (r"$\mathbf{e}$", r"$\mathbf{e}$"), [style.unit for style in shown],
                     columns=2 if len(looks) <= 8 else 4)
    elif panel == "velocity":
        looks = [(*style, label) for style, label in zip(TWIST_STYLES, TWIST_LABELS)]
        _draw_curves(record, axes, record.twist, looks, (r"$\mathbf{v}$", r"$\mathbf{\omega}$"), ("m/s", "rad/s"),
                     columns=2)
    elif panel == "path":
        _draw_path(record, axes)
    else:
        _draw_image(axes, image_of(record, panel))
        if panel in DIFFERENCES:
            axes.set_xlabel(_largest(record, panel))
            if scale:
                _draw_scale(axes)


def _draw_image(axes, image):
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(True)
    if image is None:
        _say(axes, "no image in this record")
        return
    axes.imshow(image, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    height, width = image.shape[:2]
    # Faint lines through the middle of the image show how far the object is from it. White and black dashes take turns,
    # so that the lines are seen on any background.
    axes.axhline((height - 1) / 2, color="#ffffff", alpha=0.45, linewidth=0.6, linestyle=(0, (6, 4)))
    axes.axvline((width - 1) / 2, color="#ffffff", alpha=0.45, linewidth=0.6, linestyle=(0, (6, 4)))
    axes.axhline((height - 1) / 2, color="#000000", alpha=0.25, linewidth=0.6, linestyle=(5, (6, 4)))
    axes.axvline((width - 1) / 2, color="#000000", alpha=0.25, linewidth=0.6, linestyle=(5, (6, 4)))


def _largest(record, panel):
    found = largest_difference(record, panel)
    return "" if found is None else f"largest: {found:.0f} grey levels"


def _draw_scale(axes):
    """Draws the scale of a difference right of it."""
    bar = axes.inset_axes((1.03, 0.0, 0.04, 1.0))
    bar.imshow(np.arange(256, dtype=np.uint8)[:, None], cmap="gray", vmin=0, vmax=255, aspect="auto", origin="lower",
               extent=(0.0, 1.0, -LARGEST, LARGEST))
    bar.grid(False)
    bar.set_xticks([])
    bar.set_yticks([-200, -100, 0, 100, 200])
    bar.yaxis.tick_right()
    for spine in bar.spines.values():
        spine.set_visible(True)


def _draw_curves(record, axes, values, looks, labels, units, columns):
    """Draws columns of the values over the time of the servo.

    Args: looks: (colour, dash, label) of each.  labels: of the scales on the left and on the right.  units: of all.
    """
    left, right = scales_of(units)
    values = left.factor * values
    rows = record.servo_rows
    t_s = record.servo_t_s
    axes.axhline(0.0, color=palette.GREY, linewidth=0.8)
    for (color, dash, name), column in zip(looks, values[rows].T):
        axes.plot(t_s, column, color=color, linestyle=dash, label=name)
    axes.set_xlabel("time since the servo started [s]")
    axes.set_ylabel(f"{labels[0]} {left.label}".strip())
    second_scale(axes, left, right, labels[1])
    if len(t_s) > 1:
        axes.set_xlim(0.0, t_s[-1])
        axes.legend(loc="best", ncol=columns, handlelength=1.6, columnspacing=1.2)
    else:
        _say(axes, "no servo phase in this record")


def second_scale(axes: Axes, left: Scale, right: Optional[Scale], name: str = "") -> None:
    """Draws the scale on the right of curves that are drawn by that on the left, where there is one."""
    if right is None:
        return
    part = right.factor / left.factor
    other = axes.secondary_yaxis("right", functions=(lambda y: y * part, lambda y: y / part))
    other.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    other.set_ylabel(f"{name} {right.label}".strip(), labelpad=1.0)
    other.grid(False)


def _draw_path(record, axes):
    rows = record.servo_rows
    p = 1e3 * record.X_WM[rows, :3, 3]
    p = p[np.all(np.isfinite(p), axis=1)]
    taught = record.rows("teach")
    goal = 1e3 * record.X_WM[taught[-1], :3, 3] if len(taught) else np.full(3, np.nan)
    if len(p):
        axes.plot(*p.T, color=palette.BLUE)
        axes.plot(*p[:1].T, linestyle="", marker="o", markersize=7, markerfacecolor="none", markeredgewidth=1.6,
                  color=palette.VERMILION, label="start")
    if np.all(np.isfinite(goal)):
        axes.plot(*goal[:, None], linestyle="", marker="*", markersize=11, color=palette.GREEN, label="goal (taught)")
    points = np.vstack([p, goal[None]])
    points = points[np.all(np.isfinite(points), axis=1)]
    if len(points):
        centre = (points.max(axis=0) + points.min(axis=0)) / 2
        half = max((points.max(axis=0) - points.min(axis=0)).max() / 2 * 1.08, 1.0)
        for set_limits, middle in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), centre):
            set_limits(middle - half, middle + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.06)
    axes.view_init(elev=22, azim=-57)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz"):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_pane_color((0.97, 0.97, 0.97, 1.0))
        axis.set_tick_params(pad=1.0 if name == "z" else -1.0)
        axis.set_label_text(f"${name}_W$ [mm]")
        axis.labelpad = 4.0 if name == "z" else 1.0
    if len(points):
        axes.legend(loc="upper left", handletextpad=0.2, borderaxespad=0.0)


def _say(axes, text):
    axes.text(0.5, 0.5, text, ha="center", va="center", color=palette.GREY, transform=axes.transAxes)
