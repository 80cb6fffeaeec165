"""`compare_laws` that is ended by a signal leaves no worker."""

import pathlib
import signal
import subprocess
import sys
import time

import psutil
import pytest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "compare_laws"
PATIENCE_S = 120.0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL], ids=lambda number: number.name)
def test_a_signal_ends_a_comparison_and_its_workers(number, tmp_path):
    process = subprocess.Popen([sys.executable, str(SCRIPT), "--workers", "2", "--output", str(tmp_path)],
                               stderr=subprocess.PIPE, text=True)
    end_s, workers = time.monotonic() + PATIENCE_S, []
    while sum(worker.cpu_times().user > 1.0 for worker in workers) < 2:  # at work
        assert time.monotonic() < end_s and process.poll() is None
        time.sleep(0.1)
        workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == (-number if number == signal.SIGKILL else 128 + number) and "Traceback" not in said
    assert not psutil.wait_procs(workers, timeout=PATIENCE_S)[1]
