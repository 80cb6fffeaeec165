"""What a value of a perturbation does to a run, and what a sweep does for its workers: each alone."""
import ctypes
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from aras_visual_servo_controller.scenario.scenario import load_scenario
from aras_visual_servo_controller.sweep import worker
from aras_visual_servo_controller.sweep.metrics import metric
from aras_visual_servo_controller.sweep.perturb import perturbed, put_clutter
from aras_visual_servo_controller.sweep.plan import Start, sample
from aras_visual_servo_controller.sweep.run import Bench


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("experiment_1")


class Recorder:
    """What `put_clutter` asks of a Simulation."""

    def __init__(self):
        self.solids, self.lights = [], []
        self.spawn_model, self.set_light = self.solids.append, self.lights.append


@pytest.mark.parametrize("text, solids, lights", [
    ("solids: [{name: a}, {name: b}]", ["a", "b"], []), ("lights: [{name: key}, {name: fill}]", [], ["key", "fill"]),
    ("{solids: [{name: a}], lights: [{name: key}]}", ["a"], ["key"])])
def test_clutter_puts_every_solid_and_light_of_its_file_into_the_scene(scenario, tmp_path, text, solids, lights):
    (tmp_path / "clutter.yaml").write_text(text)
    sim = Recorder()
    put_clutter(sim, scenario, str(tmp_path / "clutter.yaml"))
    assert [one["name"] for one in sim.solids] == solids and [one["name"] for one in sim.lights] == lights


@pytest.mark.parametrize("parameters, later_s", [
    ({"noise_stddev": 1.5}, 0.0), ({"latency_images": 2}, 2 / 30), ({"latency_s": 0.01}, 0.01),
    ({"latency_images": 1, "latency_s": 0.01}, 0.01 + 1 / 30)])
@pytest.mark.parametrize("before_s", [None, 0.02])
def test_images_come_later_by_what_was_asked_and_by_nothing_else(scenario, parameters, later_s, before_s):
    if before_s is not None:
        [camera] = scenario.sim["cameras"]
        scenario = scenario.with_overrides({"sim.cameras": [dict(camera, latency_s=before_s)]})
    [camera] = perturbed(scenario, parameters).sim["cameras"]
    assert camera.get("latency_s", 0.0) == pytest.approx((before_s or 0.0) + later_s)
    assert camera["noise_stddev"] == parameters.get("noise_stddev", 0.0)


@pytest.mark.parametrize("count, dimensions, shape", [
    (3, 2, (2, 1)), (5, 3, (2, 2, 1)), (2, 3, (2, 1, 1)), (7, 2, (3, 2)), (11, 2, (3, 3)), (23, 3, (3, 3, 2)),
    (8, 3, (2, 2, 2)), (5, 1, (5,))])
def test_axes_of_a_grid_have_equally_many_places_and_the_first_ones_what_is_left(count, dimensions, shape):
    points = sample("grid", count, dimensions, 0)
    for column, places in zip(points.T, shape):
        np.testing.assert_allclose(sorted(set(column)), (np.arange(places) + 0.5) / places)
    assert len({tuple(point) for point in points}) == len(points) == math.prod(shape)


def test_a_refused_start_tells_from_where_it_would_have_begun(scenario):
    offset = {"x_m": 0.003, "y_m": -0.004, "z_m": 0.012, "rx_rad": 0.03, "ry_rad": -0.04, "rz_rad": 0.12}
    row, _ = Bench(scenario).run(Start(1, None, offset, refusal="camera pose out of reach: far"))
    assert (row["x0_mm"], row["y0_mm"], row["z0_mm"]) == pytest.approx((3.0, -4.0, 12.0))
    assert (row["distance0_mm"], row["angle0_deg"]) == pytest.approx((13.0, math.degrees(0.13)))
    row, _ = Bench(scenario).run(Start(1, None, refusal="goal out of reach: far"))
    assert row["x0_mm"] is row["distance0_mm"] is row["angle0_deg"] is None


def test_a_metric_is_known_to_whoever_asks_first():
    asks = "from aras_visual_servo_controller.sweep.metrics import metric; print(metric('vit_vs').label)"
    said = subprocess.run([sys.executable, "-c", asks], stdout=subprocess.PIPE, text=True, check=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}).stdout
    assert said.strip() == metric("vit_vs").label == "ViT-VS"


@pytest.mark.parametrize("variable, calls", [({}, []),
                                             ({"MALLOC_TRIM_THRESHOLD_": "65536"}, [(-1, 256 << 20), (-3, 32 << 20)])])
def test_memory_is_kept_where_dask_would_return_it_and_the_system_takes_both_bounds(monkeypatch, variable, calls):
    library, asked = ctypes.CDLL(None), []

    class Library:
        @staticmethod
        def mallopt(parameter, value):
            asked.append((parameter, value))
            return library.mallopt(parameter, value)

    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
    for name, value in variable.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(worker.ctypes, "CDLL", lambda _: Library)
    worker._keep_memory()
    assert asked == calls
    for parameter in (-1, -3):
        library.mallopt(parameter, 128 << 10)  # as before
