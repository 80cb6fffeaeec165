"""The replay of a report in a real browser: one moment for the arm, the curves, the image and the joints."""

import dataclasses
import re

import numpy as np
import pytest
from browser import CHROMIUM, Browser
from synthetic import make_record

pytest.importorskip("cv2")
pytest.importorskip("aras_visual_servo_sim")
from aras_visual_servo_study.report import replay  # noqa: E402
from aras_visual_servo_study.report.report import save_results  # noqa: E402
import aras_visual_servo as avs  # noqa: E402
from aras_visual_servo.scenario.scenario import load_scenario  # noqa: E402

MOST_BYTES = 3_000_000
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")


@pytest.fixture(scope="module")
def record():
    return avs.run(load_scenario("experiment_1"))


@pytest.fixture(scope="module")
def page(record, tmp_path_factory):
    folder = tmp_path_factory.mktemp("replay")
    save_results(record, folder)
    return folder / "report.html"


def test_the_page_is_whole_and_no_larger_than_a_mail_takes(page):
    text = page.read_text()
    assert len(text.encode()) <= MOST_BYTES
    outside = re.findall(r"""(?:src|href)=["']?(?!data:|#)([^"' >]+)""", text.partition("<script")[0])
    assert outside == []


def test_the_same_run_gives_the_same_replay(record):
    assert replay.replay_of(record) == replay.replay_of(record)


def test_images_drawn_again_are_those_of_the_run(record):
    kept = avs.run(load_scenario("experiment_1"), keep_images=True)
    rows = kept.servo_rows
    again = replay._camera(record, load_scenario("experiment_1"), "target")
    for row in rows[[0, len(rows) // 2, -1]]:
        assert np.array_equal(again(row), kept.images[row])
    assert replay._data(kept)["again"] is False and replay._data(record)["again"] is True


def test_a_record_that_cannot_be_shown_says_why(record):
    with pytest.raises(replay.ReplayError, match="lacks its scenario"):
        replay.replay_of(make_record())
    settings = {**record.settings, "robot": {**record.settings["robot"], "urdf": "/nowhere.urdf"}}
    with pytest.raises(replay.ReplayError, match="nowhere.urdf"):
        replay.replay_of(dataclasses.replace(record, settings=settings))


def test_no_text_of_a_run_ends_the_script(record):
    shown = replay.replay_of(dataclasses.replace(record, settings={**record.settings, "name": "a"}))
    assert "<" not in shown["data"] and not any("</script" in one.lower() for one in shown["scripts"])


@needs_browser
def test_the_slider_moves_arm_curves_image_and_joints(record, page, tmp_path):
    with Browser(tmp_path, webgl=True) as browser:
        browser.open(page.as_uri())
        browser.wait("window.replay && replay.world && replay.world.last")
        assert len(browser.value("Object.keys(replay.world.robot.links)")) > 6
        row = record.servo_rows[20]
        t = (record.stamp_ns[row] - record.stamp_ns[record.servo_rows[0]]) * 1e-9
        browser.value("(() => { const slider = document.querySelector('#replay-time'); slider.value = 20; "
                      "slider.dispatchEvent(new Event('input')); })()")
        assert browser.value("document.querySelector('#errors .readout').textContent") == f"t = {t:.3f} s"
        shown = browser.value("replay.world.camera.position.toArray()")
        assert shown == pytest.approx(record.X_WC[row, :3, 3], abs=1e-5)
        # The tree of the page's own joints puts the camera where it was.
        tip = browser.value("(() => { replay.world.scene.updateMatrixWorld(); "
                            "return replay.world.robot.tip.matrixWorld.elements.slice(12, 15); })()")
        assert tip == pytest.approx(record.X_WC[row, :3, 3], abs=1e-4)
        names = browser.value("document.querySelector('#replay-joints').textContent")
        assert all(name in names for name in record.joint_names)
        browser.wait("document.querySelector('#replay-image').getContext('2d').getImageData(160, 120, 1, 1).data[3]")
        # ... and a curve moves the slider.
        browser.value("document.dispatchEvent(new CustomEvent('seek', { detail: 0 }))")
        assert browser.value("document.querySelector('#replay-time').value") == "0"
        assert browser.said == []


@needs_browser
def test_without_webgl_image_and_joints_stay(page, tmp_path):
    with Browser(tmp_path, size=(390, 844)) as browser:
        browser.open(page.as_uri())
        browser.wait("replay.moments")
        assert "no WebGL" in browser.value("document.querySelector('#replay-note').textContent")
        browser.wait("document.querySelector('#replay-image').getContext('2d').getImageData(160, 120, 1, 1).data[3]")
        assert browser.value("document.documentElement.scrollWidth <= innerWidth")
