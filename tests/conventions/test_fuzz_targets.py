"""Every fuzz target says what it reads, begins with small seeds, and stands in the table of docs/fuzzing.md."""
import importlib.machinery
import importlib.util
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_BYTES = 1024  # of a seed: longer inputs are not made up


def script():
    """script/fuzz as a module."""
    loader = importlib.machinery.SourceFileLoader("fuzz_script", str(ROOT / "script" / "fuzz"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    sys.modules[loader.name], before = module, sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    loader.exec_module(module)
    sys.dont_write_bytecode = before
    return module


fuzz = script()


@pytest.mark.parametrize("target", fuzz.targets(), ids=lambda target: target.name)
def test_a_target_is_described_and_has_small_seeds(target):
    first, *_, last = target.reads
    assert first.isupper() and last == "." and "|" not in target.reads
    seeds = list(target.seeds.iterdir())
    assert 2 <= len(seeds) <= 16 and all(seed.stat().st_size <= MOST_BYTES for seed in seeds)
    assert target.name in fuzz.rows(fuzz.PAGE.read_text()), "run script/fuzz 0 --record"


def test_names_of_targets_are_unique():
    names = [target.name for target in fuzz.targets()]
    assert len(names) == len(set(names))


def result(target, executions, findings=()):
    return fuzz.Result(target, executions, 1.0, 50, list(findings))


def test_executions_add_up_and_a_finding_begins_anew(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- fuzz -->\n<!-- end fuzz -->\nafter\n")
    monkeypatch.setattr(fuzz, "PAGE", page)
    one, other = fuzz.targets()[:2]
    fuzz.record([result(one, 1000), result(other, 7)])
    fuzz.record([result(one, 234), result(other, 9, [page])])
    rows = fuzz.rows(page.read_text())
    assert rows[one.name][2:4] == ["1 234", "50"] and rows[other.name][2] == "0"
    assert rows[fuzz.targets()[2].name][2:] == ["0", "0", "never"]
    assert page.read_text().startswith("before\n") and page.read_text().endswith("after\n")


def test_no_time_means_what_is_in_the_corpus_alone():
    assert (fuzz.how_long(0.0), fuzz.how_long(0.2), fuzz.how_long(60.0)) == \
        ("-runs=0", "-max_total_time=1", "-max_total_time=60")


def test_an_unknown_target_is_refused_with_those_there_are(capsys):
    with pytest.raises(SystemExit, match="found the target nobody, allowed .*urdf"):
        fuzz.chosen(["nobody"])
