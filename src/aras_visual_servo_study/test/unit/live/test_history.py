"""What a page can go back to stays bounded, and reaches to the beginning of the session."""

import errno
import math

from aras_visual_servo_study.live.history import Pictures, packed, thinned, unpacked
from aras_visual_servo_study.live.page_run import rounded


def test_the_older_half_is_thinned_in_even_steps():
    rows = []
    for number in range(5000):
        rows.append(number)
        if len(rows) > 400:
            rows = thinned(rows, float)
    steps = [b - a for a, b in zip(rows, rows[1:])]
    assert rows[0] == 0 and rows[-200:] == list(range(4800, 5000)) and min(steps) == 1
    assert max(steps) < 3 * 4800 / 100  # a fourth of the bound, evenly over the time before


def test_pictures_keep_their_bound_and_the_whole_session():
    pictures = Pictures(1000)
    assert pictures.at(3) is None
    for number in range(500):
        pictures.keep(number, b"%04d" % number + bytes(16))
        assert pictures.size <= 1000
    pictures.keep(499, b"again")
    assert pictures.at(499)[:4] == b"0499" and pictures.at(9999)[:4] == b"0499" and pictures.at(0)[:4] == b"0000"
    found = int(pictures.at(250)[:4])
    assert 150 < found <= 250


def test_a_row_keeps_its_six_digits_and_its_whole_numbers():
    numbers = [rounded(sign * mantissa * 10.0**power) for sign in (-1, 1) for power in range(-9, 6)
               for mantissa in (1.0, math.pi, 9.99999, 9.876543)]
    row = [0.0, None, 16_000_001, *numbers]
    assert unpacked(packed(row)) == row


def test_a_picture_that_cannot_be_written_is_not_kept(monkeypatch):
    pictures = Pictures(1000)
    pictures.keep(1, b"first")

    class Full:
        def seek(self, _place):
            pass

        def write(self, _picture):
            raise OSError(errno.ENOSPC, "full")

    with monkeypatch.context() as patch:
        patch.setattr(pictures, "_file", Full())
        pictures.keep(2, b"second")
    assert pictures.at(2) == b"first"
    pictures.keep(3, b"third")
    assert pictures.at(3) == b"third"
