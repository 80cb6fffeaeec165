"""README.md and docs/ state the figures of docs/figures.yaml, and `script/figures` renews both."""
import json
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
AGAIN = "script/figures renews what runs make; a text that was rewritten has its words in docs/figures.yaml"


@pytest.fixture
def figures(docs):
    return docs("figures")


@pytest.fixture
def sources(docs):
    return docs("figure_sources")


def test_every_text_states_its_figures(figures):
    listed, missing = figures.load(), []
    for text in listed["texts"]:
        words = figures.say(text["text"], listed["figures"])
        if len(figures.pattern(words).findall((ROOT / text["file"]).read_text())) != 1:
            missing.append(f"{text['file']}: allowed once, '{words}'")
    assert not missing, "\n".join([*missing, AGAIN])


def test_every_figure_is_stated_and_says_what_makes_it(figures, sources):
    listed = figures.load()
    stated = {name for text in listed["texts"] for name in figures.names_in(text["text"])}
    assert stated == set(listed["figures"])
    for name, figure in listed["figures"].items():
        assert isinstance(figure["value"], (int, float)) and figure["made_by"], name
        if figure["made_by"] == "table":
            assert name.split(".")[-1] in sources.CELL_KEYS, name
        if figure["made_by"] == "run":
            assert figure["tolerance"] > 0 and name.split(".")[-1] in sources.RUN_KEYS, name


def test_figures_of_tables_are_those_of_their_cells(figures, sources):
    stated = figures.load()["figures"]
    off = [f"{name}: the cell says {value:g}, stated {stated[name]['value']:g}"
           for name, value in sources.made_by_tables(stated).items() if value != stated[name]["value"]]
    assert not off, "\n".join([*off, AGAIN])


def test_figures_of_tests_stand_in_those_tests(figures, sources):
    faults = [f"{name}: {fault}" for name, figure in figures.load()["figures"].items()
              if figure["made_by"].startswith(sources.TEST)
              and (fault := sources.fault_of_test(
                  figure["made_by"], figure["value"] * (0.01 if name.endswith("percent") else 1.0)))]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("made_by, value, fault", [
    ("test test_a.py::test_one", 0.02, None), ("test test_a.py::test_one", 1.5, None),
    ("test test_a.py::test_one", 0.03, "0.03 is not in the test 'test_one' of test_a.py, nor in a constant there"),
    ("test test_a.py::test_three", 0.03, "no test 'test_three' in test_a.py"),
    ("test test_b.py::test_one", 0.02, "no file 'test_b.py'"),
    ("test a_test.cpp::One", 0.02, None), ("test a_test.cpp::One", 1.5, None),
    ("test a_test.cpp::One", 0.03, "0.03 is not in the test 'One' of a_test.cpp, nor in a constant there"),
    ("test a_test.cpp::Three", 0.03, "no test 'Three' in a_test.cpp")])
def test_a_number_that_its_test_does_not_state_is_named(sources, tmp_path, made_by, value, fault):
    (tmp_path / "test_a.py").write_text("MM = 1.5\n\ndef test_one():\n    assert a < 0.02\n\ndef test_two():\n"
                                        "    assert a < 0.03\n")
    (tmp_path / "a_test.cpp").write_text("constexpr double kMm = 1.5;\n\nTEST(A, One)\n{\n  EXPECT_LT(a, 0.02);\n}\n"
                                         "\nTEST(A, Two)\n{\n  EXPECT_LT(a, 0.03);\n}\n")
    assert sources.fault_of_test(made_by, value, tmp_path) == fault


def test_a_new_value_goes_into_the_list_and_into_the_text(figures, sources, tmp_path):
    (tmp_path / "page.md").write_text("The loop runs\nat 113 times; 24 600 steps, 1e-7. Another 113 times.\n")
    listed = {"runs": {}, "exceptions": {"published": [{"file": "page.md", "text": "1 mm"}]},
              "figures": {"loop": {"value": 113, "made_by": "script/bench: loop"},
                          "steps": {"value": 24600, "made_by": "script/bench: steps"},
                          "depth": {"value": 1e-7, "made_by": "script/bench: depth"}},
              "texts": [{"file": "page.md", "text": "The loop runs at {loop:.0f} times; {steps:t} steps, {depth:p}"}]}
    made = sources.made_by_bench(listed["figures"], {"loop": 120.4, "steps": 31257.0, "depth": 2e-7})
    changes = [("loop", 113, 120.4), ("steps", 24600, 31260.0), ("depth", 1e-7, 2e-7)]
    assert figures.renew(listed, made, tmp_path) == changes
    assert (tmp_path / "page.md").read_text() == "The loop runs at 120 times; 31 300 steps, 2e-7. Another 113 times.\n"
    figures.save(listed, tmp_path / "figures.yaml")
    assert figures.load(tmp_path / "figures.yaml") == json.loads(json.dumps(listed))


def test_a_text_that_is_not_there_is_an_error_that_shows_it(figures, tmp_path):
    (tmp_path / "page.md").write_text("Nothing here.\n")
    listed = {"figures": {"loop": {"value": 1, "made_by": "run"}},
              "texts": [{"file": "page.md", "text": "{loop:.0f} x"}]}
    with pytest.raises(SystemExit, match="found 0 times '1 x', allowed once"):
        figures.renew(listed, {"loop": 2}, tmp_path)


def test_a_sweep_gives_the_figures_that_have_its_name(sources, monkeypatch):
    monkeypatch.setattr(sources, "sweep_figures", lambda folder: (folder, {"drawn": 7, "rate": 50.0}))
    listed = {"sweep.domain.drawn": {}, "sweep.domain.rate": {}, "sweep.other.drawn": {}, "loop": {}}
    assert sources.made_by_sweep(listed, "domain") == {"sweep.domain.drawn": 7, "sweep.domain.rate": 50.0}
