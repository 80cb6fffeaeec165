"""What the tests of every room use: the folder of the shared helpers, test/support, in their path, and a fixture."""
import pathlib
import signal
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))


@pytest.fixture
def hang_up_is_heard():
    """SIGHUP ends a program again during the test. Under nohup the program and those that it starts would ignore it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)
