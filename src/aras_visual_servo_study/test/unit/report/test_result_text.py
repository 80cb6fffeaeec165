"""Texts and parts of a page: stop rule, settings, versions, pictures, video, replay, templates."""

import dataclasses
import os
from importlib import metadata

import cv2
import numpy as np
import pytest
from synthetic import blob, make_record, SETTINGS

from aras_visual_servo_study.report import page, replay, report, template, versions
from aras_visual_servo_study.report.drawing import Drawing
from aras_visual_servo_study.report.rows import stop_rows
from aras_visual_servo_study.report.video import Film


def with_stop(values, rule="pose"):
    """A record whose stop rule knew these values at its last images: rows of STOP_NAMES."""
    settings = dict(SETTINGS, servo=dict(SETTINGS["servo"], stop={"rule": rule, "tilt_rad": 0.002, "position_m": 0.001,
                                                                  "rotation_rad": 0.004}))
    record = make_record(settings=settings)
    stop = np.full((len(record), 4), np.nan)
    stop[record.servo_rows[-len(values):]] = values
    return dataclasses.replace(record, stop=stop)


def test_of_what_the_stop_rule_judged_the_last_known_value_is_told():
    summary = report.summarise(with_stop([[0.1, 0.2, 0.3, 4.0], [0.5, 0.6, 0.7, 8.0], [0.001, 0.0005, np.nan, 9.0],
                                          [np.nan, np.nan, np.nan, np.nan]]))
    assert summary["stop"] == {"rule": "pose", "cond_l": 9.0, "tilt_rad": {"found": 0.001, "allowed": 0.002},
                               "position_m": {"found": 0.0005, "allowed": 0.001},
                               "rotation_rad": {"found": 0.7, "allowed": 0.004}}
    assert report.summarise(make_record())["stop"]["tilt_rad"]["found"] is None


def test_only_the_rule_of_the_pose_judges_more_than_features():
    stop = {"cond_l": 1.0, "tilt_rad": {"found": 0.0011, "allowed": 0.002},
            "position_m": {"found": 0.0005, "allowed": 0.001}, "rotation_rad": {"found": 0.0123, "allowed": 0.004}}
    rows = stop_rows({"stop": {"rule": "pose", **stop}})
    assert [row["found"] for row in rows] == ["0.063 deg", "0.5 mm", "0.705 deg"]
    assert [row["allowed"] for row in rows] == ["0.115 deg", "1 mm", "0.229 deg"]
    assert [row["label"] for row in rows] == ["tilt", "distance from the goal", "angle from the goal"]
    assert stop_rows({"stop": {"rule": "features", **stop}}) == stop_rows({"stop": None}) == []
    assert stop_rows({"stop": {"rule": "pose", "tilt_rad": {"found": None}}}) == []


@pytest.mark.parametrize("settings, rows", [
    ({"servo": {"law": "pbvs", "hold_s": 0.2}}, [("servo.law", "pbvs"), ("servo.hold_s", "0.2")]),
    ({"servo": {"gains": {"xn": 1.0, "yn": 2.0}}}, [("servo.gains", "xn 1.0, yn 2.0")]),
    ({"servo": {"gains": {}}}, []),
    ({"sim": {"cameras": [{"name": "a", "width": 3}, {"name": "b"}]}},
     [("sim.cameras[0]", "name a, width 3"), ("sim.cameras[1]", "name b")]),
    ({"sim": {"scene": {"models": [{"name": "a", "pose": {"x": 1}}]}}},
     [("sim.scene.models[0].name", "a"), ("sim.scene.models[0].pose", "x 1")]),
    ({"vision": {"grey": [1, 2]}}, [("vision.grey", "1, 2")]), ({"name": "elsewhere", "time": {"a": 1}}, [])])
def test_every_setting_that_influences_a_result_is_a_row(settings, rows):
    assert page.flat_settings(dataclasses.replace(make_record(), settings=settings)) == rows


def test_the_version_of_a_library_is_the_longest_that_its_files_name(tmp_path, monkeypatch):
    for name in ("libvisp_core.so.3.5", "libvisp_core.so.3.5.0", "libvisp_core.so.3", "libkdl.so.9",
                 "libBulletDynamics.so.3.24", "libBulletDynamics-float64.so.3.24", "libopencv_core.so.406",
                 "libopencv_core.so.4.6.0", "liborocos-kdl.so.1.5.x"):
        (tmp_path / name).touch()

    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(versions, "_FOLDERS", (str(tmp_path), str(tmp_path / "missing")))
    monkeypatch.setattr(versions.metadata, "version", missing)
    found = versions.installed_versions.__wrapped__()
    assert {name: found.get(name) for name in versions._LIBRARIES} == {
        "visp": "3.5.0", "bullet": "3.24", "opencv": "4.6.0", "kdl": None}
    assert found["numpy"] == found["matplotlib"] == "unknown"


@pytest.mark.parametrize("image", [blob(3), blob(3)[..., 0]], ids=["rgb", "grey"])
def test_a_picture_of_the_page_is_read_as_it_was(image):
    read = cv2.imdecode(np.frombuffer(page.png_bytes(image), np.uint8), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(read if image.ndim == 2 else cv2.cvtColor(read, cv2.COLOR_BGR2RGB), image)


@pytest.mark.parametrize("size, beside", [(8_000_000, False), (8_000_001, True)])
def test_a_video_that_is_too_large_for_a_mail_stands_beside_the_page(tmp_path, size, beside):
    (tmp_path / "video.mp4").write_bytes(bytes(size))
    film = page._film(Film(tmp_path / "video.mp4", blob(0), 9, 0.5))
    assert film["beside"] == beside and (film["src"] == "video.mp4") == beside
    assert (film["width"], film["height"], film["speed"]) == (64, 48, 0.5)


@pytest.mark.parametrize("count, most, first, last", [(3, 400, 0, 2), (400, 400, 0, 399), (1000, 400, 0, 999)])
def test_moments_of_the_replay_lie_evenly_between_the_first_and_the_last(count, most, first, last):
    rows = replay._spread(np.arange(count) + 7, most) - 7
    assert (rows[0], rows[-1], len(rows)) == (first, last, min(count, most))
    assert np.ptp(np.diff(rows)) <= 1


def test_the_process_that_draws_does_other_work_side_by_side():
    with Drawing() as drawing:
        assert drawing.side_by_side(divmod, [(7, 2), (9, 4), (1, 1)]) == [(3, 1), (2, 1), (1, 0)]
        with pytest.raises(ZeroDivisionError):
            drawing.side_by_side(divmod, [(7, 2), (9, 0)])


@pytest.mark.parametrize("mode, user, kept", [(0o700, 0, True), (0o755, 0, True), (0o775, 0, False), (0o757, 0, False),
                                              (0o700, 1, False)])
def test_compiled_templates_are_run_only_from_a_folder_of_ones_own(tmp_path, monkeypatch, mode, user, kept):
    folder = tmp_path / "aras_visual_servo"
    folder.mkdir()
    folder.chmod(mode)
    own = folder.stat().st_uid
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(os, "getuid", lambda: own + user)
    assert (template._environment.__wrapped__().bytecode_cache is not None) == kept
