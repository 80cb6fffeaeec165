"""Every fuzz target begins with small seeds and stands in the table of docs/fuzzing.md."""
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "fuzzing.md").read_text()
TARGETS = sorted(ROOT.glob("src/*/fuzz/*.cpp"))
MOST_BYTES = 1024  # of an input that script/fuzz makes up


@pytest.mark.parametrize("target", TARGETS, ids=lambda path: path.stem)
def test_a_target_has_small_seeds_and_stands_in_the_table(target):
    seeds = list((target.parent / "corpus" / target.stem).iterdir())
    assert 2 <= len(seeds) <= 16 and all(seed.stat().st_size <= MOST_BYTES for seed in seeds)
    assert f"| `{target.stem}` |" in PAGE


def test_names_of_targets_are_unique():
    assert len({target.stem for target in TARGETS}) == len(TARGETS) > 10
