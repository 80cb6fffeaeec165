"""Where this package keeps what is not Python: templates, comparisons, protocols and the live page."""

from pathlib import Path

from aras_visual_servo import package_path


def share_dir() -> Path:
    """Returns the folder with `config` and `web`: in the source tree, or PREFIX/share of the installed package."""
    return package_path("aras_visual_servo_study")
