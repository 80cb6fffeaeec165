"""bench/constraints.py keeps its runs in a file, and goes on with it."""

import importlib.util
import pathlib
from types import SimpleNamespace

import numpy as np
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


PACKAGE = pathlib.Path(__file__).resolve().parents[3]
PAGE = PACKAGE.parents[1] / "docs" / "features_and_laws.md"
HALVED = 1e-5  # of the radius: the length of a displacement is found to 1e-6


@pytest.fixture(scope="module")
def domain():
    spec = importlib.util.spec_from_file_location("photometric_domain", PACKAGE / "bench" / "photometric_domain.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("radius", [0.03, 0.3])
def test_a_start_moves_the_image_by_the_radius(domain, radius):
    half = np.tan(0.5 * domain.FIELD_RAD)
    u, v = np.meshgrid(np.linspace(-half, half, 9), np.linspace(-0.75 * half, 0.75 * half, 7))
    places = []
    for seed in range(5):
        X = domain.displacement(np.random.default_rng(seed), radius)
        seen = (domain.Z_STAR_M * np.stack([u, v, np.ones_like(u)], -1) - X[:3, 3]) @ np.linalg.inv(X[:3, :3]).T
        off = np.hypot(seen[..., 0] / seen[..., 2] - u, seen[..., 1] / seen[..., 2] - v)
        assert np.sqrt(np.mean(off**2)) / (2.0 * half) == pytest.approx(radius, rel=HALVED / radius)
        places.append(X[:3, 3])
    assert np.ptp(places, axis=0).min() > 0.0


@pytest.mark.parametrize("rates, text", [
    ([1, 1, 1, 1, 0, 0], "18 %"), ([0, 0, 0, 0, 0, 0], "2 %"), ([1, 1, 1, 1, 1, 0.75], "> 30 %")])
def test_half_arrive_between_the_radii_of_the_table(domain, rates, text):
    assert domain.half_radius(rates) == text


def test_the_page_has_the_rows_that_are_measured(domain):
    rows = PAGE.read_text().partition(domain.BEGIN)[2].partition(domain.END)[0].splitlines()[3:]
    assert [row.split(" | ")[0].lstrip("| ") for row in rows] == list(domain.WAYS)
