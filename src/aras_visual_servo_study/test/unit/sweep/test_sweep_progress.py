"""How a sweep is cut into pieces for its workers, and what it tells while it runs."""
import sys
import time

import pytest

from aras_visual_servo_study.sweep import engine


@pytest.mark.parametrize("count, workers, sizes", [
    (1, 1, [1]), (9, 1, [2, 2, 2, 2, 1]), (64, 2, [8] * 8), (63, 2, [7] * 9), (1000, 1, [8] * 125), (4, 8, [1] * 4)])
def test_every_worker_is_given_four_pieces_at_least_and_none_has_more_than_eight_runs(count, workers, sizes):
    pieces = engine._chunks(list(range(count)), workers)
    assert [len(piece) for piece in pieces] == sizes and sum(pieces, []) == list(range(count))


@pytest.mark.parametrize("seconds, text", [
    (0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (125.0, "2 min 5 s"), (3599.4, "59 min 59 s"),
    (3600.0, "1 h 0 min"), (3725.0, "1 h 2 min"), (90000.0, "25 h 0 min")])
def test_a_time_left_has_two_units_at_most(seconds, text):
    assert engine._duration(seconds) == text


class Screen:
    """A stream. Args: terminal: whether it says that it is one."""

    def __init__(self, terminal):
        self.text, self.isatty = "", lambda: terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def progress_of(terminal, seconds, every_s=10.0, total=4, done=()):
    """What is shown when a run comes in at each of these times."""
    now, screen = [0.0], Screen(terminal)
    progress = engine.Progress(total, done, screen, every_s, lambda: now[0])
    for now[0] in seconds:
        progress.add([{"outcome": "success"}])
    progress.end()
    return screen.text


def test_a_terminal_has_one_line_that_is_written_again():
    text = progress_of(True, [0.19, 0.2, 0.3, 0.39])
    assert text.startswith("\r2/4 runs") and text.count("\r") == 2 and text.endswith("4 success\n")
    assert text.count("\n") == 1


def test_a_file_has_a_new_line_from_time_to_time_and_one_at_the_end():
    lines = progress_of(False, [9.9, 10.0, 19.9, 19.95]).splitlines()
    assert [line.split("  ")[0] for line in lines] == ["2/4 runs", "4/4 runs"]
    assert progress_of(False, [9.9, 10.0, 19.9], total=5).count("\n") == 1


def test_a_rate_is_of_this_process_and_without_one_the_time_left_is_not_known():
    before, counts = [{"outcome": "failure"}] * 2, "2 failure, 1 success\n"
    assert progress_of(False, [0.0], 0.0, 4, before) == f"3/4 runs  0.0 runs/s  time left unknown  {counts}"
    assert progress_of(False, [2.0], 0.0, 4, before) == f"3/4 runs  0.5 runs/s  2 s left  {counts}"


def test_progress_is_shown_on_stderr_when_nobody_says_where(capsys):
    progress = engine.Progress(1)
    progress.add([{"outcome": "success"}])
    assert capsys.readouterr().err.startswith("1/1 runs  ") and progress._clock is time.monotonic


def test_progress_tells_rate_and_time_left():
    now = iter([0.0, 5.0, 5.0, 10.0, 10.0, 10.0])
    before = [{"outcome": "success"}] * 20
    progress = engine.Progress(100, before, stream=sys.stderr, every_s=5.0, clock=lambda: next(now))
    progress.add([{"outcome": "success"}] * 9 + [{"outcome": "failure"}])
    assert "30/100 runs" in progress.line()
    assert "1.0 runs/s  1 min 10 s left  29 success, 1 failure" in progress.line()
