"""Puts the folder of the shared test helpers, test/support, where the tests of every room find it."""
import pathlib
import signal
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))


@pytest.fixture
def hang_up_is_heard():
    """A hang-up is not ignored, as it is by all that nohup starts, nor by the programs that the test starts."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)
