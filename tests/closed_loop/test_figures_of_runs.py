"""The figures of README.md and docs/ that runs in process make are those that the runs make now."""
import importlib.util
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_runs_make_the_figures_that_the_texts_state():
    spec = importlib.util.spec_from_file_location("figures", ROOT / "script" / "docs" / "figures.py")
    figures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(figures)
    listed = figures.load()["figures"]
    made = figures.made_by_runs(listed)
    off = [f"{name}: found {value:.4g}, stated {listed[name]['value']:g} +-{listed[name]['tolerance']:g}"
           for name, value in made.items() if not abs(value - listed[name]["value"]) <= listed[name]["tolerance"]]
    assert made and not off, "\n".join([*off, "script/figures makes them again"])
