"""Parts of a page: its pictures, its video, the moments of its replay, and where its templates are kept."""
import os

import cv2
import numpy as np
import pytest
from synthetic import blob

from aras_visual_servo_study.report import page, replay, template
from aras_visual_servo_study.report.drawing import Drawing
from aras_visual_servo_study.report.video import Film


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
