"""What the tests of every room use: the folder of the shared helpers, test/support, in their path, and a fixture."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from hang_up import hang_up_is_heard

__all__ = ["hang_up_is_heard"]
