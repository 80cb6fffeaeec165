"""Puts the folder of the shared test helpers, test/support, where the tests of every room find it."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
