"""gzclient without a window."""
import os
import pathlib
import signal
import subprocess
import sys

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "scripts" / "gzclient"


def test_without_a_display_it_stays_until_it_is_ended():
    """A required node that ends would end the whole launch."""
    without = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    for number in (signal.SIGINT, signal.SIGTERM):
        with subprocess.Popen([sys.executable, str(SCRIPT), "--verbose", "__name:=gui"], env=without, text=True,
                              stdout=subprocess.PIPE) as client:
            assert "no window" in client.stdout.readline()
            try:
                client.wait(0.5)
                ended = True
            except subprocess.TimeoutExpired:
                ended = False
            client.send_signal(number)
            assert (ended, client.wait(30)) == (False, 0)
