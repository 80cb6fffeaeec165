"""bench/constraints.py keeps its runs in a file, and goes on with it."""

import importlib.util
import pathlib
from types import SimpleNamespace

import pytest

PATH = pathlib.Path(__file__).resolve().parents[3] / "bench" / "constraints.py"


@pytest.fixture
def bench(monkeypatch):
    spec = importlib.util.spec_from_file_location("constraints_bench", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.ran = []

    def run(job):
        module.ran.append(job[2].id)
        return job[2].id, {"success": job[2].id % 2 == 0}

    monkeypatch.setattr(module, "run", run)
    return module


def jobs(*numbers):
    return [("arm", "qp", SimpleNamespace(id=number)) for number in numbers]


def test_runs_that_are_in_the_file_are_not_done_again(bench, tmp_path):
    path = tmp_path / "runs"
    first = bench.Kept(path, {"seed": 0}).run(jobs(1, 2), None)
    again = bench.Kept(path, {"seed": 0}).run(jobs(1, 2, 3), None)
    assert bench.ran == [1, 2, 3] and again[:2] == first == [{"success": False}, {"success": True}]
    assert bench.Kept(path, {"seed": 0}).run(jobs(3, 1), None) == [again[2], again[0]] and bench.ran == [1, 2, 3]


def test_a_line_that_was_cut_off_is_run_again_and_the_file_stays_whole(bench, tmp_path):
    path = tmp_path / "runs"
    bench.Kept(path, {"seed": 0}).run(jobs(1, 2), None)
    path.write_text(path.read_text()[:-9])
    bench.Kept(path, {"seed": 0}).run(jobs(1, 2), None)
    assert bench.ran == [1, 2, 2] and bench.Kept(path, {"seed": 0}).run(jobs(1, 2), None) and bench.ran == [1, 2, 2]


def test_runs_of_other_scenarios_are_refused(bench, tmp_path):
    path = tmp_path / "runs"
    bench.Kept(path, {"seed": 0}).run(jobs(1), None)
    with pytest.raises(SystemExit, match="found runs of other scenarios or seeds"):
        bench.Kept(path, {"seed": 1})
