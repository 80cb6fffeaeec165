"""script/gallery makes every picture that it should, and the tables: with runs that are cut short, and two laws."""
import pathlib

import cv2
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Pictures that `benchmark map` and `benchmark latency` make.
OTHERS = {"convergence.png", "latency.png"}
LAWS, TASKS, SHORT = ("points_goal", "pbvs"), ("turn_90",), {"servo.time_limit_s": 0.2}


@pytest.fixture
def small(docs, monkeypatch):
    """The module of script/gallery, with little to do."""
    gallery, animation = docs("gallery"), docs("animation")
    load, load_laws, run_laws = gallery.load_scenario, gallery.load_comparison, gallery.run_comparison
    for module in (gallery, animation):
        monkeypatch.setattr(module, "load_scenario", lambda name: load(name, SHORT))
    monkeypatch.setattr(docs("tutorial"), "load_scenario", lambda name, changes: load(name, {**changes, **SHORT}))
    monkeypatch.setattr(gallery, "load_comparison",
                        lambda name, scenario: load_laws(name, LAWS, TASKS, scenario=scenario))
    monkeypatch.setattr(gallery, "run_comparison", lambda comparison, workers: run_laws(comparison, workers=0))
    monkeypatch.setattr(gallery, "LAWS", LAWS)
    monkeypatch.setattr(gallery, "TASKS", TASKS)
    return gallery


def test_every_picture_of_the_pages_and_the_tables_are_made(small, docs, tmp_path):
    images, page = tmp_path / "docs" / "images", tmp_path / "docs" / "comparison.md"
    page.parent.mkdir()
    page.write_text((ROOT / "docs" / "comparison.md").read_text())
    small.main(images)
    made = {path.name for path in images.iterdir()}
    assert made == {path.name for path in (ROOT / "docs" / "images").iterdir()} - OTHERS
    for path in images.iterdir():
        assert path.suffix == ".webp" or cv2.imread(str(path)).std() > 5.0, f"{path.name} shows nothing"
        assert path.read_bytes()[8:12] == b"WEBP" or path.suffix == ".png"
    for table in docs("comparison").TABLES:
        assert set(docs("comparison").read(page.read_text(), table)) == {(law, TASKS[0]) for law in LAWS}
