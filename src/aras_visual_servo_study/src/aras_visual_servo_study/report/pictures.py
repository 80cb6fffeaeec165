"""Titles and images of the panels of a run, for the figure and for the page. numpy only."""

from typing import Optional

import numpy as np

from aras_visual_servo import RunRecord

PANELS = ("desired", "initial", "difference", "errors", "velocity", "path")
TITLES = {"desired": "desired image", "initial": "initial image", "difference": "final $-$ desired",
          "errors": "feature errors", "velocity": "camera velocity", "path": "path of the camera",
          "start": "initial $-$ desired"}
#: Panels that show how an image differs from the desired one; the largest difference, in grey levels, that they show.
DIFFERENCES, LARGEST = ("start", "difference"), 255
#: Instead, where the arm carries the target and the camera stands still.
EYE_TO_HAND = {"velocity": "camera velocity, seen from the target", "path": "path of the target"}


def panel_title(record: RunRecord, panel: str) -> str:
    """Title of a panel. In look-then-move each look moves the camera by the law's velocity times the sample time."""
    servo = record.settings.get("servo", {})
    if panel == "velocity" and servo.get("mode") == "look_then_move":
        return f"velocity of the law, T = {servo.get('sample_time_s', 0.01):g} s per look"
    return EYE_TO_HAND.get(panel, TITLES[panel]) if record.eye_to_hand else TITLES[panel]


def image_of(record: RunRecord, panel: str) -> Optional[np.ndarray]:
    """The image of a panel, uint8, (h, w) or (h, w, 3); None if the record lacks it.

    Args: panel: "desired", "initial", "difference" (final - desired, as in the paper's Fig. 4(c) and 5(c)) or "start"
        (initial - desired). A difference of two images is mid grey where they are equal.
    """
    if panel == "desired":
        return record.desired_image
    if panel == "initial":
        return record.initial_image
    difference = _difference(record, panel)
    return None if difference is None else np.clip(np.rint(128.0 + 0.5 * difference), 0, 255).astype(np.uint8)


def largest_difference(record: RunRecord, panel: str) -> Optional[float]:
    """The largest size of one of DIFFERENCES, in grey levels; None if the record lacks an image."""
    difference = _difference(record, panel)
    return None if difference is None else float(np.abs(difference).max())


def _difference(record, panel):
    other = record.initial_image if panel == "start" else record.final_image
    if other is None or record.desired_image is None or other.shape != record.desired_image.shape:
        return None
    return _grey(other) - _grey(record.desired_image)


def _grey(image):
    return image.astype(float) if image.ndim == 2 else image.astype(float).mean(axis=2)
