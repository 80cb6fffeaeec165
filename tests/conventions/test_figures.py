"""README.md and docs/ state the figures of docs/figures.yaml, and `script/figures` renews both."""
import importlib.util
import json
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
AGAIN = "script/figures renews what runs make; a text that was rewritten has its words in docs/figures.yaml"


@pytest.fixture(scope="module")
def figures():
    """Module script/docs/figures.py."""
    spec = importlib.util.spec_from_file_location("figures", ROOT / "script" / "docs" / "figures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_text_states_its_figures(figures):
    listed, missing = figures.load(), []
    for text in listed["texts"]:
        words = figures.say(text["text"], listed["figures"])
        if len(figures.pattern(words).findall((ROOT / text["file"]).read_text())) != 1:
            missing.append(f"{text['file']}: allowed once, '{words}'")
    assert not missing, "\n".join([*missing, AGAIN])


def test_every_figure_is_stated_and_says_what_makes_it(figures):
    listed = figures.load()
    stated = {name for text in listed["texts"] for name in figures.names_in(text["text"])}
    assert stated == set(listed["figures"])
    for name, figure in listed["figures"].items():
        assert isinstance(figure["value"], (int, float)) and figure["made_by"], name
        if figure["made_by"] == "run":
            assert figure["tolerance"] > 0 and name.split(".")[-1] in figures.RUN_KEYS, name


def test_a_new_value_goes_into_the_list_and_into_the_text(figures, tmp_path):
    (tmp_path / "page.md").write_text("The loop runs\nat 113 times; 24 600 steps. Another 113 times.\n")
    listed = {"figures": {"loop": {"value": 113, "made_by": "script/bench: loop"},
                          "steps": {"value": 24600, "made_by": "script/bench: steps"}},
              "texts": [{"file": "page.md", "text": "The loop runs at {loop:.0f} times; {steps:t} steps"}]}
    made = figures.made_by_bench(listed["figures"], {"loop": 120.4, "steps": 31257.0})
    assert figures.renew(listed, made, tmp_path) == [("loop", 113, 120.4), ("steps", 24600, 31260.0)]
    assert (tmp_path / "page.md").read_text() == "The loop runs at 120 times; 31 300 steps. Another 113 times.\n"
    figures.save(listed, tmp_path / "figures.yaml")
    assert figures.load(tmp_path / "figures.yaml") == json.loads(json.dumps(listed))


def test_a_text_that_is_not_there_is_an_error_that_shows_it(figures, tmp_path):
    (tmp_path / "page.md").write_text("Nothing here.\n")
    listed = {"figures": {"loop": {"value": 1, "made_by": "run"}},
              "texts": [{"file": "page.md", "text": "{loop:.0f} x"}]}
    with pytest.raises(SystemExit, match="found 0 times '1 x', allowed once"):
        figures.renew(listed, {"loop": 2}, tmp_path)


def test_a_sweep_gives_the_figures_that_have_its_name(figures, monkeypatch):
    monkeypatch.setattr(figures, "sweep_figures", lambda folder: (folder, {"drawn": 7, "rate": 50.0}))
    listed = {"sweep.domain.drawn": {}, "sweep.domain.rate": {}, "sweep.other.drawn": {}, "loop": {}}
    assert figures.made_by_sweep(listed, "domain") == {"sweep.domain.drawn": 7, "sweep.domain.rate": 50.0}
