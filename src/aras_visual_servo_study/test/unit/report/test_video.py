"""Video of a run: features where they are, the arm where it was, clear words when something is missing."""

import dataclasses
import shutil
import subprocess

import numpy as np
import pytest

pytest.importorskip("cv2")
pytest.importorskip("aras_visual_servo_sim")
from aras_visual_servo import expand, styles  # noqa: E402
from aras_visual_servo.palette import rgb  # noqa: E402
from aras_visual_servo.ground.errors import ParameterError  # noqa: E402
from aras_visual_servo_study.live.view.projection import project  # noqa: E402
from aras_visual_servo_study.report import video  # noqa: E402
import aras_visual_servo as avs  # noqa: E402
from aras_visual_servo_study.report.observer import Observer, ObserverError  # noqa: E402
from aras_visual_servo_study.report.report import save_results  # noqa: E402
from aras_visual_servo.scenario.scenario import load_scenario  # noqa: E402

# A blob's centre of dark pixels and its centroid differ by what its grey border weighs.
CENTRE_PX = 0.7
needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")


@pytest.fixture(scope="module")
def record():
    return avs.run(load_scenario("experiment_1"), keep_images=True)


@pytest.fixture(scope="module")
def short(record):
    """The first quarter second of it."""
    images = {row: record.images[row] for row in record.servo_rows[:8]}
    return dataclasses.replace(record, images=images)


def test_every_servo_image_is_kept_only_when_asked_for(record):
    assert sorted(record.images) == record.servo_rows.tolist()
    assert np.array_equal(record.images[record.servo_rows[0]], record.initial_image)


def test_features_are_drawn_where_the_object_is(record):
    row = record.servo_rows[0]
    v, u = np.nonzero(record.images[row][..., 0] < 125)
    [[x, y]] = project(record.raw[row:row + 1, 1:3], record.camera_info)
    assert abs(x - u.mean()) < CENTRE_PX and abs(y - v.mean()) < CENTRE_PX


@pytest.mark.parametrize("scenario", ["six_dof_points", "six_dof_pbvs", "six_dof_photometric"])
def test_each_kind_of_feature_is_drawn_in_its_own_way(scenario):
    run = avs.run(load_scenario(scenario), keep_images=True)
    overlay = video.overlay_of(run)
    composer = video.Composer(run, list(run.servo_rows))
    plain = np.array(composer._camera_view(3)).astype(int)
    composer._overlay = video.Overlay(difference=overlay.difference)
    drawn = np.abs(plain - composer._camera_view(3)).max(axis=2) > 40
    scale = min(video.HALF / 320, video.VIEW_HEIGHT / 240)
    for way in overlay.ways:
        u, v = np.rint((way.seen[3] + 0.5) * scale - 0.5).astype(int)
        if 4 < u < video.HALF - 4 and 4 < v < video.VIEW_HEIGHT - 4:
            assert drawn[v - 3:v + 4, u - 3:u + 4].any(), way
    assert drawn.any() and (overlay.ways or overlay.shapes)
    assert overlay.difference == (scenario == "six_dof_photometric")


def test_a_lens_bends_where_features_are_drawn_and_nothing_stays_nothing():
    info = {"K": [100.0, 0, 50.0, 0, 100.0, 40.0, 0, 0, 1], "D": [-0.3, 0.1, 0, 0, 0], "distortion_model": "plumb_bob"}
    pixels = project(np.array([[0.0, 0.0], [0.5, 0.0], [np.nan, 0.0]]), info)
    assert np.allclose(pixels[0], [50.0, 40.0]) and np.isnan(pixels[2]).all()
    assert pixels[1, 0] == pytest.approx(50 + 100 * 0.5 * (1 - 0.3 * 0.25 + 0.1 * 0.0625))
    with pytest.raises(ParameterError, match="no camera_info"):
        project(pixels, {})


def test_the_observer_sees_the_arm_move(record):
    observer = Observer(record, 160, 120)
    first, again, last = (observer.picture(record.q[row]) for row in record.servo_rows[[0, 0, -1]])
    assert first.shape == (120, 160, 3) and np.array_equal(first, again)
    assert np.abs(first.astype(int) - last).max() > 100


def test_the_observer_stands_in_the_same_place_for_a_run_and_its_bag(record):
    # Poses that went through a quaternion differ in their last bits, and rows after the end are not in a bag.
    other = dataclasses.replace(record, X_WC=record.X_WC + 1e-13, X_WT=record.X_WT - 1e-13)
    other.X_WC[record.servo_rows[-1] + 1:] += 1.0
    q = record.q[record.servo_rows[0]]
    assert np.array_equal(Observer(record, 160, 120).picture(q), Observer(other, 160, 120).picture(q))


def test_the_observer_sees_light_and_shadow(record, monkeypatch):
    from aras_visual_servo_study.report import observer as module
    q = record.q[record.servo_rows[0]]
    observer = Observer(record, 160, 120)
    lit = observer.picture(q).astype(int)
    assert "Mesa" in observer.drawn_by
    monkeypatch.setattr(module, "LIGHTING", dict(module.LIGHTING, shadows=False))
    without = Observer(record, 160, 120).picture(q).astype(int)
    in_shadow = (without - lit).max(axis=2) > 25
    assert in_shadow.sum() > 100 and (lit - without).max() <= 1


def test_without_opengl_the_observer_draws_without_shadows(record, monkeypatch):
    import aras_visual_servo_sim

    def missing(gl="osmesa"):
        raise aras_visual_servo_sim.RenderError("no such library")

    monkeypatch.setattr(aras_visual_servo_sim, "opengl_description", missing)
    observer = Observer(record, 160, 120)
    assert np.ptp(observer.picture(record.q[0]).astype(int)) > 100 and observer.drawn_by == ""


def test_a_record_without_its_scenario_cannot_be_observed(record):
    with pytest.raises(ObserverError, match="robot is unknown"):
        Observer(dataclasses.replace(record, settings={}))


def test_errors_are_drawn_up_to_the_moment_shown(short):
    composer = video.Composer(short, sorted(short.images))
    early, late = composer.frame(1), composer.frame(7)
    assert early.shape == (video.VIEW_HEIGHT + video.CURVES_HEIGHT, video.WIDTH, 3)
    curves = slice(video.VIEW_HEIGHT, None)
    colourful = [np.ptp(frame[curves].astype(int), axis=2).sum() for frame in (early, late)]
    assert colourful[1] > 1.2 * colourful[0]


@pytest.mark.parametrize("names", [("xn", "yn", "an", "alpha"), expand(("points4",)), ("photometric",)])
def test_the_curves_have_the_colours_of_the_features(short, names):
    level = np.resize(np.linspace(0.2, -0.2, len(names)), (len(short), len(names)))
    wanted = {rgb(style.colour) for style in styles(names)}
    for e, columns in ((level, slice(0, video.WIDTH // 6)), (np.full_like(level, np.nan), slice(None))):
        # The curves, left of the legend; then the legend alone, since there are no errors to draw.
        renamed = dataclasses.replace(short, feature_names=names, e=e, s=level, s_star=0.0 * level)
        composer = video.Composer(renamed, sorted(short.images))
        strip = composer.frame(7)[video.VIEW_HEIGHT:, columns]
        assert wanted <= {tuple(pixel) for pixel in strip.reshape(-1, 3).tolist()}


@needs_ffmpeg
def test_the_video_has_a_frame_per_image_and_is_the_same_every_time(short, tmp_path):
    film = video.save_video(short, tmp_path / "a.mp4")
    video.save_video(short, tmp_path / "b.mp4")
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()
    held = round(video.HOLD_S * 30)
    assert film.frames == 8 - 1 + held and {path.name for path in tmp_path.iterdir()} == {"a.mp4", "b.mp4"}
    asked = ["-count_frames", "-show_entries", "stream=nb_read_frames,width,pix_fmt", "-of", "csv=p=0"]
    seen = subprocess.run(["ffprobe", "-v", "error", *asked, str(tmp_path / "a.mp4")], capture_output=True, text=True,
                          check=True).stdout
    assert seen.strip() == f"{video.WIDTH},yuv420p,{film.frames}"


@needs_ffmpeg
def test_the_report_holds_the_video(short, tmp_path):
    summary = save_results(short, tmp_path, video=True)
    text = (tmp_path / "report.html").read_text()
    assert 'src="data:video/mp4;base64,' in text and (tmp_path / "video.mp4").is_file() and not summary["notes"]


def test_without_ffmpeg_the_report_is_written_and_says_so(short, tmp_path, monkeypatch):
    monkeypatch.setattr(video.shutil, "which", lambda _: None)
    summary = save_results(short, tmp_path, video=True)
    assert summary["notes"] == ["no video: ffmpeg is not installed; on Debian: apt install ffmpeg"]
    assert "<video" not in (tmp_path / "report.html").read_text()


def test_an_encoder_that_fails_is_quoted_and_leaves_no_half_video(short, tmp_path):
    broken = tmp_path / "encoder"
    broken.write_text("#!/bin/sh\necho no such codec >&2\nexit 3\n")
    broken.chmod(0o755)
    with pytest.raises(video.VideoError, match="exit code 3: no such codec"):
        video.save_video(short, tmp_path / "a.mp4", ffmpeg=str(broken))
    assert [path.name for path in tmp_path.iterdir()] == ["encoder"]
