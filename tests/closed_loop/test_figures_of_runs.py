"""The figures of README.md and docs/ that runs in process make are those that the runs make now."""
import pathlib
import re

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"


def test_runs_make_the_figures_that_the_texts_state(docs):
    listed = docs("figures").load()
    made, stated = docs("figure_sources").made_by_runs(listed), listed["figures"]
    off = [f"{name}: found {value:.4g}, stated {stated[name]['value']:g} +-{stated[name]['tolerance']:g}"
           for name, value in made.items() if not abs(value - stated[name]["value"]) <= stated[name]["tolerance"]]
    assert made and not off, "\n".join([*off, "script/figures makes them again"])


def test_the_run_hash_of_the_readme_is_that_of_the_run(run):
    assert re.findall(r"`([0-9a-f]{16})`", README.read_text()) == [run("experiment_1").run_hash]
