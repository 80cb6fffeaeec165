"""Hands the newest sample of a run to every page that is ready for it. Knows no sockets: a viewer is asked to `send`.

Each viewer says which messages it has seen. One that is more than WINDOW messages behind gets none until it has caught
up, and then the newest: what came between is dropped, and neither the run nor another viewer waits.
"""

import io
import json
import struct
from typing import Any, Dict, Sequence

import numpy as np

from aras_visual_servo import eight_bit
from .history import Pictures, unpacked

WINDOW = 6
QUALITY = 88  # of JPEG
#: Rows that one message carries at most; a page that has missed more takes them in turn.
MOST_ROWS = 3000


class Hub:
    """Makes the messages, each once for all viewers.

    Attributes: pictures: `Pictures` that pages were sent, with their marks, for a page that goes back in time.

    Args: runner: `Runner`, or what has its attributes sample, rows, servos, about and watched.
        notes: what a page is told to begin with, beside what the runner has to say.
    """

    def __init__(self, runner: Any, notes: Sequence[str] = ()) -> None:
        self._runner, self._notes, self._viewers = runner, list(notes), []
        self._number, self._about, self._goal = -1, None, None
        self._image_number, self._jpeg = -1, b""
        self.pictures = Pictures()

    def add(self, viewer: Any) -> None:
        """A page has come: `viewer` has send(bytes or str), and gets attributes such as `behind` and `next_row`."""
        viewer.behind, viewer.next_row, viewer.next_servo, viewer.image_number = 0, 0, 0, -1
        self._viewers.append(viewer)
        self._runner.watched = self._runner.attended = True
        viewer.send(_text(self._about_message()))
        if self._goal is not None:
            viewer.send(_goal_message(self._goal))

    def __contains__(self, viewer: Any) -> bool:
        return viewer in self._viewers

    def remove(self, viewer: Any) -> None:
        """A page has gone."""
        if viewer in self._viewers:
            self._viewers.remove(viewer)
        self._runner.watched = self._runner.attended = bool(self._viewers)

    @property
    def viewers(self) -> int:
        """How many pages look."""
        return len(self._viewers)

    def _about_message(self):
        about = self._runner.about
        return {"type": "about", **about, "notes": list(about.get("notes", ())) + self._notes}

    def tell(self, message: Dict[str, Any]) -> None:
        """Send a message, dict, to every page."""
        text = _text(message)
        for viewer in list(self._viewers):
            viewer.send(text)

    def tick(self) -> None:
        """Called some sixty times a second: hand out what is new."""
        runner = self._runner
        # Nothing is made for pages that are all behind, as nothing is for none.
        runner.watched = any(viewer.behind < WINDOW for viewer in self._viewers)
        if not self._viewers:
            return
        about = runner.about
        if self._about != about["version"]:
            if self._about is not None:
                self.tell(self._about_message())
                for viewer in self._viewers:
                    viewer.next_row = 0 if not runner.rows else min(viewer.next_row, runner.rows[-1][0] + 1)
                self._goal = None  # a page forgets the goal with what it knew: it is sent again
            self._about = about["version"]
        sample = runner.sample
        if sample is None or sample.number == self._number:
            return
        self._number = sample.number
        if sample.goal is not None and (self._goal is None or self._goal[1] is not sample.goal[1]):
            message = _goal_message(sample.goal)
            for viewer in self._viewers:
                viewer.send(message)
        self._goal = sample.goal
        ready = [viewer for viewer in self._viewers if viewer.behind < WINDOW]
        made = {}
        for viewer in ready:
            with_image = viewer.image_number != sample.image_number and sample.image is not None
            key = viewer.next_row, with_image
            if key not in made:
                made[key] = self._message(sample, *key)
            message, next_row = made[key]
            for number, servo in list(self._runner.servos):  # read after the rows: a servo is known before its rows
                if number >= viewer.next_servo:
                    viewer.send(_text(servo))
                    viewer.next_servo = number + 1
            viewer.next_row, viewer.image_number = next_row, sample.image_number
            viewer.behind += 1
            viewer.send(message)

    def _message(self, sample, first_row, with_image):
        """(bytes, next row): length of the head (uint32), the head in JSON, the image as JPEG."""
        rows = self._rows(first_row)
        head = {"type": "now", "number": sample.number, "state": sample.state, "viewers": len(self._viewers),
                "rows": [unpacked(row) for _, row in rows]}
        image = b""
        if with_image:
            head["marks"] = sample.marks
            image = self._encoded(sample)
        return _framed(head, image), rows[-1][0] + 1 if rows else first_row

    def _rows(self, first):
        """The rows from this one on, MOST_ROWS of them at most: then every second, third ... from the newest back."""
        found = []
        for entry in reversed(self._runner.rows):
            if entry[0] < first:
                break
            found.append(entry)
        return found[::-(-len(found) // MOST_ROWS) or 1][::-1]

    def _encoded(self, sample):
        if self._image_number != sample.image_number:
            self._jpeg, self._image_number = jpeg(sample.image), sample.image_number
            self.pictures.keep(sample.image_number, _framed({"type": "picture", "marks": sample.marks}, self._jpeg))
        return self._jpeg


def jpeg(image: np.ndarray) -> bytes:
    """The bytes of a JPEG of an image, uint8 or uint16, (h, w) grey or (h, w, 3) rgb."""
    import PIL.Image  # OpenCV writes the same bytes, and takes ten times as long to import
    stream = io.BytesIO()
    colour = {"subsampling": "4:2:0"} if image.ndim == 3 else {}
    PIL.Image.fromarray(np.ascontiguousarray(eight_bit(image))).save(stream, "JPEG", quality=QUALITY, **colour)
    return stream.getvalue()


def _goal_message(goal):
    _, image, marks, pose = goal
    return _framed({"type": "goal", "marks": marks, "pose": pose}, jpeg(image))


def _framed(head, image):
    """Length of the head (uint32), the head in JSON, the image."""
    text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
    return struct.pack("<I", len(text)) + text + image


def _text(message):
    return json.dumps(message, separators=(",", ":"), allow_nan=False, default=_plain)


def _plain(value):
    if isinstance(value, (np.floating, np.integer)):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    return str(value)
