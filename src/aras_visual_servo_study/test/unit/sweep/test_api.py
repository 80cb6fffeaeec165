"""Sweeps, comparisons and published protocols without the command line."""

import math

import pytest

import aras_visual_servo as avs

LAW = """
import numpy as np
import aras_visual_servo as avs

@avs.register_law("standing")
class Standing(avs.Law):
    works_on = None

    def _twist(self, look, s, e):
        return np.zeros(6)
"""


@pytest.fixture(scope="module")
def ours():
    return avs.sweep("experiment_1", starts=6, workers=0, quiet=True)


def test_equal_arguments_give_equal_rows_whatever_the_workers(ours):
    assert [row["id"] for row in ours.rows] == [start.id for start in ours.starts] == list(range(1, 7))
    assert avs.sweep(avs.load_scenario("experiment_1"), starts=6, workers=2, quiet=True).rows == ours.rows
    assert ours.success.value == 1.0 and 0.5 < ours.success.low < 1.0 == ours.success.high
    assert str(ours).startswith("experiment_1: 6 runs") and ours.plot("curve").axes


def test_a_saved_sweep_is_continued_and_refuses_another_one(ours, tmp_path):
    folder = tmp_path / "mine"
    assert ours.save(folder).name == "sweep.html" and (folder / "runs.csv").is_file()
    assert avs.sweep("experiment_1", starts=6, folder=folder, quiet=True).rows == ours.rows
    with pytest.raises(avs.ParameterError, match="another scenario"):
        avs.sweep("experiment_1", starts=5, folder=folder, quiet=True)


def test_a_law_of_a_plugin_is_compared_on_the_same_starts(ours, tmp_path, monkeypatch):
    (tmp_path / "standing_law.py").write_text(LAW)
    monkeypatch.syspath_prepend(tmp_path)
    other = avs.sweep("experiment_1", starts=6, law="standing", plugins=["standing_law"], workers=0, quiet=True,
                      overrides={"servo.time_limit_s": 0.5})
    found = avs.compare(ours, other)
    assert other.success.value == 0.0 and found.numbers["B.only_a"] == 6 and found.holds("B.success < A.success")
    assert math.isnan(found.numbers["B.time_median_s"]) and found.save(tmp_path / "both").is_file()
    with pytest.raises(avs.ParameterError):
        avs.compare(ours)
    with pytest.raises(avs.ParameterError, match="starts differ"):
        avs.compare(ours, avs.sweep("experiment_1", starts=6, seed=1, workers=0, quiet=True))


def test_a_protocol_is_run_with_a_law_of_a_plugin(tmp_path, monkeypatch):
    (tmp_path / "standing_law.py").write_text(LAW)
    monkeypatch.syspath_prepend(tmp_path)
    asked = {"starts": 1, "cases": ["standing_free"], "law": "standing", "plugins": ["standing_law"], "workers": 0,
             "overrides": {"servo.time_limit_s": 0.5}, "folder": tmp_path / "runs"}
    result = avs.benchmark("canonical", **asked)
    assert [(case.name, len(rows)) for case, rows in result.results] == [("standing_free_camera", 1)]
    line = dict(zip(*result.table))
    assert (line["law"], line["starts"], line["success"]) == ("standing", "1", "0.0 %")
    assert result.save(tmp_path / "table").read_text() == str(result)
    assert avs.benchmark("canonical", quiet=True, **asked).results == result.results  # gone on with: nothing to do
    with pytest.raises(avs.ParameterError, match="allowed standing_free_camera"):
        avs.benchmark("canonical", **{**asked, "cases": ["coco"]})
    for wrong in ({"protocol": "coco"}, {"protocol": "canonical", "own": {"board": "mine.png"}},
                  {"protocol": "canonical", "plugins": ["no_such_module"]}):
        with pytest.raises(avs.ParameterError):
            avs.benchmark(**wrong)
