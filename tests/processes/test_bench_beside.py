"""script/bench --beside: other programs are measured in turn with ours, and the ratio says whose is better."""
import importlib.util
import pathlib
import sys

import pytest

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "script" / "bench.py"


@pytest.fixture
def bench():
    spec = importlib.util.spec_from_file_location("bench", PROGRAM)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_programs_run_in_turn_and_the_ratio_is_that_of_each_turn(bench, capsys, tmp_path):
    order = tmp_path / "order"
    other = tmp_path / "other.sh"
    other.write_text(f"echo other >> {order}\necho 'frames per second: 50'\n")
    values = iter([100.0, 200.0, 100.0])

    def ours():
        with open(order, "a") as file:
            file.write("ours\n")
        return next(values)

    bench.compare("what", ours, [f"sh {other}"], 3)
    assert order.read_text().split() == ["ours", "other"] * 3
    said = capsys.readouterr().out.splitlines()
    assert said[0].split()[:2] == ["what", "100.00"] and "[100.00 .. 200.00] of 3 runs" in said[0]
    assert str(other)[-40:] in said[1] and "ours is 2.00 times as good" in said[1]


def test_of_what_should_be_small_the_smaller_is_better(bench, capsys):
    bench.compare("what", lambda: 2.0, ["echo 1"], 1, more_is_better=False)
    assert "ours is 0.50 times as good" in capsys.readouterr().out


def test_a_program_stands_beside_what_it_was_given_for(bench, monkeypatch):
    beside = bench.read_beside(["loop=echo 1", "camera=echo a=2", "loop=echo 3"])
    assert beside["loop"] == ["echo 1", "echo 3"] and beside["camera"] == ["echo a=2"]
    seen = {}
    monkeypatch.setattr(bench, "compare", lambda what, ours, others, runs, better=True: seen.update({what: others}))
    monkeypatch.setattr(bench, "row", lambda *words: None)
    monkeypatch.setattr(bench.subprocess, "run", lambda *words, **options: type("Done", (), {"stdout": "a 1 MiB,"}))
    bench.in_process(1, beside["loop"])
    bench.simulator(1, beside)
    assert {what: others for what, others in seen.items() if others} == {
        "whole loop in process, simulated / wall seconds, one core": ["echo 1", "echo 3"],
        bench.IN_TURN["camera"][0]: ["echo a=2"]}


@pytest.mark.parametrize("entry", ["nothing=echo 1", "loop", "loop= "])
def test_what_cannot_be_measured_is_refused(bench, monkeypatch, entry):
    monkeypatch.setattr(sys, "argv", ["bench", "--beside", entry])
    with pytest.raises(SystemExit, match="allowed WHAT=COMMAND with WHAT one of loop, physics"):
        bench.main()
