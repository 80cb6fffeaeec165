"""Video of a run: the camera's image with what its features see in it, an observer's view of the arm, and the errors.

    film = save_video(record, folder / "video.mp4")      # a record made with keep_images=True

Frames come from the record alone (images, features, joint positions), so a run in process and its bag give the same
video. ffmpeg encodes it as a child process. No ROS, no display.
"""

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Sequence, Union

import numpy as np

from aras_visual_servo import ArasError, ParameterError, RunRecord, palette, styles
from .image_plot import coloured_difference
from .overlays.base import Overlay, overlay_of
from .scales import scales_of

WIDTH, VIEW_HEIGHT, CURVES_HEIGHT = 1280, 480, 240
HALF = WIDTH // 2
LEGEND_COLUMNS = 8
LEFT, RIGHT = 0.08, 0.93      # ends of the time axis, parts of the width
HOLD_S = 0.8                  # the last frame is shown for this long
WANTED_RGB = palette.rgb(palette.GREEN)
SUBPIXEL_BITS = 4             # cv2 draws at fractions of a pixel
ENCODER = ("-c:v", "libx264", "-preset", "veryfast", "-crf", "21", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
           "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1")


class VideoError(ArasError):
    """The video cannot be made. The text says what is missing."""


@dataclass(frozen=True)
class Film:
    """A video that was written: its path, a frame of it (h, w, 3), frames, and its speed against simulated time."""

    path: Path
    poster: np.ndarray
    frames: int
    speed: float = 1.0


def save_video(record: RunRecord, path: Union[str, Path], ffmpeg: str = "ffmpeg") -> Film:
    """Write the video of the servo phase, one frame per image, at the speed of simulated time.

    Args: path: of the .mp4; an earlier file there is replaced when this one is complete.  ffmpeg: the encoder.
    Raises: VideoError: ffmpeg is missing or failed (its words are quoted), or the record lacks images or its robot.
    """
    program = shutil.which(ffmpeg)
    if program is None:
        raise VideoError(f"{ffmpeg} is not installed; on Debian: apt install ffmpeg")
    rows = [row for row in record.servo_rows if row in record.images]
    if len(rows) < 2:
        raise VideoError("the record has no images of the servo phase (record the group images)")
    path = Path(path)
    partial = path.with_name(path.name + ".part")
    spans = np.diff(record.stamp_ns[rows]) * 1e-9
    rate_hz = 1.0 / float(np.median(spans))
    command = [program, "-nostdin", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
               "-s", f"{WIDTH}x{VIEW_HEIGHT + CURVES_HEIGHT}", "-r", f"{rate_hz:.6f}", "-i", "-", *ENCODER,
               "-f", "mp4", str(partial)]
    frames, poster, words = 0, None, b""
    composer = Composer(record, rows)
    try:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            for index in range(len(rows)):
                frame = composer.frame(index)
                poster = frame if index == len(rows) // 8 else poster
                for _ in range(1 if index + 1 < len(rows) else max(1, round(HOLD_S * rate_hz))):
                    process.stdin.write(frame.tobytes())
                    frames += 1
        except BrokenPipeError:
            pass  # ffmpeg has ended; what it printed says why, and is reported below
        except BaseException:
            process.kill()
            raise
        finally:
            _, words = process.communicate()
        if process.returncode:
            raise VideoError(f"ffmpeg ended with exit code {process.returncode}: "
                             + words.decode(errors="replace").strip()[-400:])
        partial.replace(path)
    except OSError as error:
        raise VideoError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        partial.unlink(missing_ok=True)
    return Film(path, frame if poster is None else poster, frames)


class Composer:
    """Makes the frames of a video of these rows of a record. Raises VideoError: its robot cannot be shown."""

    def __init__(self, record: RunRecord, rows: Sequence[int]) -> None:
        from .observer import Observer, ObserverError
        self._record, self._rows = record, rows
        try:
            self._observer = Observer(record, HALF, VIEW_HEIGHT)
        except ObserverError as error:
            raise VideoError(str(error)) from error
        self._t_s = (record.stamp_ns[rows] - record.stamp_ns[rows[0]]) * 1e-9
        try:
            self._overlay = overlay_of(record) or Overlay()
        except ParameterError as error:
            raise VideoError(str(error)) from error
        self._at = np.searchsorted(record.servo_rows, rows)  # places of these rows in what the overlay says
        self._faint, self._full, self._left, self._right = self._curves()

    def frame(self, index: int) -> np.ndarray:
        """Frame `index`: uint8 (VIEW_HEIGHT + CURVES_HEIGHT, WIDTH, 3)."""
        frame = np.empty((VIEW_HEIGHT + CURVES_HEIGHT, WIDTH, 3), np.uint8)
        frame[:VIEW_HEIGHT, :HALF] = self._camera_view(index)
        frame[:VIEW_HEIGHT, HALF:] = self._observer.picture(self._record.q[self._rows[index]])
        frame[:VIEW_HEIGHT, HALF - 1:HALF + 1] = 255
        share = self._t_s[index] / max(self._t_s[-1], 1e-9)
        column = int(round(self._left + share * (self._right - self._left)))
        curves = frame[VIEW_HEIGHT:]
        curves[:] = self._faint
        curves[:, :column] = self._full[:, :column]
        curves[8:-44, column:column + 2] = 90
        return frame

    def _camera_view(self, index):
        """The camera's image, as large as fits, with the features that are seen and those that are wanted drawn in."""
        import cv2
        image = self._record.images[self._rows[index]]
        if self._overlay.difference and self._record.desired_image is not None:
            image = coloured_difference(image, self._record.desired_image)
        image = np.repeat(image[..., None], 3, axis=2) if image.ndim == 2 else image
        scale = min(HALF / image.shape[1], VIEW_HEIGHT / image.shape[0])
        size = (round(image.shape[1] * scale), round(image.shape[0] * scale))
        view = np.full((VIEW_HEIGHT, HALF, 3), 40, np.uint8)
        x0, y0 = (HALF - size[0]) // 2, (VIEW_HEIGHT - size[1]) // 2
        picture = np.ascontiguousarray(cv2.resize(image, size, interpolation=cv2.INTER_NEAREST))

        self._draw_overlay(picture, scale, index)
        cv2.putText(picture, f"t = {self._t_s[index]:.2f} s", (12, size[1] - 14), cv2.FONT_HERSHEY_SIMPLEX, 0.75,
                    (60, 60, 60), 1, cv2.LINE_AA)
        view[y0:y0 + size[1], x0:x0 + size[0]] = picture
        return view

    def _draw_overlay(self, picture, scale, index):
        """Draw what the features see into the enlarged image: shapes and ways now, thin where they are wanted."""
        import cv2
        now = self._at[index]

        def at(p):
            """(u, v) of the camera's image as cv2 takes points: fixed-point numbers, here of the enlarged picture."""
            return tuple(int(round(((x + 0.5) * scale - 0.5) * (1 << SUBPIXEL_BITS))) for x in p)

        def lines(points, colour, width, closed=False):
            for a, b in zip(points, [*points[1:], *points[:1]] if closed else points[1:]):
                if np.isfinite(a).all() and np.isfinite(b).all():
                    cv2.line(picture, at(a), at(b), colour, width, cv2.LINE_AA, SUBPIXEL_BITS)

        def ring(p, colour, radius_px, width):
            if np.isfinite(p).all():
                cv2.circle(picture, at(p), round(radius_px * (1 << SUBPIXEL_BITS)), colour, width, cv2.LINE_AA,
                           SUBPIXEL_BITS)

        for shape in self._overlay.shapes:
            if shape.wanted is not None:
                lines(list(shape.wanted), palette.rgb(shape.colour), 1, shape.closed)
            lines(list(shape.seen[now]), palette.rgb(shape.colour), 2, shape.closed)
        named = {shape.name: shape.colour for shape in self._overlay.shapes}
        named.update({f"{way.name} {way.subscript}".strip(): way.colour for way in self._overlay.ways})
        for row, (name, colour) in enumerate(named.items()):
            cv2.putText(picture, name, (12, 24 + 20 * row), cv2.FONT_HERSHEY_SIMPLEX, 0.5, palette.rgb(colour), 1,
                        cv2.LINE_AA)
        for way in self._overlay.ways:
            lines(list(way.seen[:now + 1]), palette.rgb(way.colour), 1)
            ring(way.wanted, WANTED_RGB, 8, 2)
            ring(way.seen[now], palette.rgb(way.colour), 4, cv2.FILLED)

    def _curves(self):
        """The plot of the feature errors in faint and in full colours, (CURVES_HEIGHT, WIDTH, 3) each, and the columns
        of pixels where its time axis begins and ends."""
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        from .figure import STYLE, second_scale
        shown, pictures, dpi = styles(self._record.feature_names), [], 100
        for strength in (0.22, 1.0):
            with matplotlib.rc_context(dict(STYLE, **{"font.size": 13, "axes.labelsize": 14, "xtick.labelsize": 13,
                                                      "ytick.labelsize": 13, "legend.fontsize": 14})):
                figure = Figure(figsize=(WIDTH / dpi, CURVES_HEIGHT / dpi), dpi=dpi)
                canvas = FigureCanvasAgg(figure)
                axes = figure.add_axes((LEFT, 0.24, RIGHT - LEFT, 0.72))
                left, right = scales_of(style.unit for style in shown)
                for style, column in zip(shown, self._record.e[self._rows].T):
                    axes.plot(self._t_s, left.factor * column, alpha=strength, linewidth=2.4, color=style.colour)
                    axes.plot([], [], color=style.colour, linewidth=2.4, label=style.mathtext)
                axes.set_xlim(0.0, max(self._t_s[-1], 1e-9))
                axes.set_xlabel("time since the servo started [s]", labelpad=1)
                axes.set_ylabel(r"$\mathbf{e}$ " + left.label)
                second_scale(axes, left, right)
                axes.legend(loc="upper right", ncol=min(len(shown), LEGEND_COLUMNS), handlelength=1.2,
                            columnspacing=1.2)
                canvas.draw()
                pictures.append(np.array(canvas.buffer_rgba())[:, :, :3])
        return (*pictures, LEFT * WIDTH, RIGHT * WIDTH)
