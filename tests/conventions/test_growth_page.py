"""docs/performance.md tells where costs bend, from figures that script/docs/growth.py measured."""
import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "script/docs"))
import growth_page  # noqa: E402


@pytest.mark.parametrize("counts,costs,at", [
    ([1, 2, 4, 8], [10.0, 12.0, 16.0, 24.0], None),   # straight
    ([1, 2, 4, 8], [10.0, 12.0, 16.0, 30.0], 4),      # 3.5 each where it was 2
    ([1, 2, 4, 8], [10.0, 15.0, 18.0, 22.0], None),   # the first ones cost most
    ([1, 2, 4, 8], [10.0, 10.0, 13.0, 30.0], 4),      # next to nothing at first
    ([1, 2, 4], [10.0, 10.0, 13.0], None),            # too few to tell
])
def test_a_bend_is_where_one_more_costs_much_more_than_before(counts, costs, at):
    assert growth_page.bend(counts, costs) == at


def test_the_page_tells_every_figure_and_the_pictures_are_drawn(tmp_path):
    measured = growth_page.Measured(
        series=[("Legs of a chair", "legs", "us a step", [1, 2, 4, 8], [10.0, 12.0, 16.0, 52.0])],
        sizes={(80, 60): (3.0, 3.0), (160, 120): (9.0, 8.0), (320, 240): (30.0, 30.0), (640, 480): (200.0, 180.0)},
        workers={1: 50.0, 2: 99.0, 4: 150.0}, frames={"in process": {"physics": 90.0, "features": 30.0}},
        whole_us=200.0, machine="a desk", repetitions=5)
    text = growth_page.page(measured)
    for line in ("Measured on a desk.", "| legs | us a step | one more |", "| 8 | 52 | 9 |", "It bends at 4 legs",
                 "| physics | 90 |", "| sum | 120 |", "costs 200 us: 167 times real time",
                 "| 640 x 480 | 200 | 180 | 1.24 |", "It bends at 320 x 240", "| 4 | 150 | 75 % |",
                 "It bends at 4 workers"):
        assert line in text, line
    assert max(map(len, text.splitlines())) <= 132
    growth_page.draw_growth(measured, tmp_path / "growth.png")
    growth_page.draw_budget(measured.frames, tmp_path / "budget.png")
    assert all((tmp_path / name).read_bytes().startswith(b"\x89PNG") for name in ("growth.png", "budget.png"))
