"""A fixture for tests that end programs as a closed terminal does."""
import signal

import pytest


@pytest.fixture
def hang_up_is_heard():
    """SIGHUP ends a program again during the test. Under nohup the program and those that it starts would ignore it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)
