"""What the tests of every room use: the folders of the shared helpers in their path, and a fixture."""
import pathlib
import sys

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
for package in (PACKAGE, PACKAGE.parent / "aras_visual_servo", PACKAGE.parent / "aras_visual_servo_controller"):
    sys.path.insert(0, str(package / "test" / "support"))

from hang_up import hang_up_is_heard

__all__ = ["hang_up_is_heard"]
