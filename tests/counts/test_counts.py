"""No piece of work needs 5 % more instructions than counts.json says. About a minute; `script/test counts`."""
import copy
import json

import counts
import pytest

FIGURES = json.loads(counts.FIGURES.read_text())


def found_with(piece=None, more=0.0, function=None, by=0):
    """The figures as if they had been counted, with one piece and one function grown."""
    found = copy.deepcopy({"pieces": FIGURES["pieces"], "functions": FIGURES["functions"]})
    if piece:
        found["pieces"][piece] = round((1.0 + more) * found["pieces"][piece])
    if function:
        found["functions"][function] = found["functions"].get(function, 0) + by
    return found


@pytest.mark.parametrize("piece", counts.PIECES)
def test_what_needs_more_is_named_with_the_function_that_grew_most(piece):
    assert counts.compare(FIGURES, found_with(piece, 0.04), FIGURES["made_with"]) == []
    slower, grown = counts.compare(FIGURES, found_with(piece, 0.06, "a_new_function()", 12345), FIGURES["made_with"])
    assert slower.startswith(f"{piece}: found ") and "6.0 % more" in slower
    assert grown == "grown most, instructions a frame: a_new_function() by 12,345 to 12,345"


def test_other_versions_are_named():
    piece = next(iter(counts.PIECES))
    *_, last = counts.compare(FIGURES, found_with(piece, 0.06), dict(FIGURES["made_with"], compiler="cc 99"))
    assert f"compiler {FIGURES['made_with']['compiler']} -> cc 99" in last


def test_callgrinds_file_is_read_function_by_function():
    text = """version: 1
events: Ir

ob=(1) /usr/lib/libours.so
fl=(1) ours.cpp
fn=(1) ours::step(int)
10 100
cfn=(2) ours::hash()
calls=3 20
11 60
fn=(2)
20 50
cfn=(3) 0x0000000000004c80
calls=3 0
+1 10
ob=(2) /usr/lib/libtheirs.so
fn=(3)
* 10
fn=(1)
12 5
"""
    own, inclusive = counts.costs_of(text)
    assert own == {"ours::step(int)": 105, "ours::hash()": 50, "unnamed in libtheirs.so": 10}
    assert inclusive == {"ours::step(int)": 165, "ours::hash()": 60, "unnamed in libtheirs.so": 10}


def test_no_piece_became_slower():
    versions = counts.made_with()
    other = counts.other_versions(FIGURES, versions)
    if other:
        pytest.skip(f"counted with {', '.join(other)}: nothing to compare with here")
    slower = counts.compare(FIGURES, counts.count(), versions)
    assert not slower, "\n" + "\n".join(slower)
