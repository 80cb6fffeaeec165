"""What a page can go back to stays bounded, and reaches to the beginning of the session."""

from aras_visual_servo_study.live.history import Pictures, thinned


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
