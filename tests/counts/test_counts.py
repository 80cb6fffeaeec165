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


@pytest.mark.parametrize("place,function", [
    ("???:f::g(int) [/usr/lib/x.so.1]", "f::g(int)"),
    ("./string/../sysdeps/x86_64/memset.S:__memset_avx2 [/usr/lib/libc.so.6]", "__memset_avx2"),
    ("???:0x000000000033 [/usr/lib/libopencv_imgproc.so.4.6.0]", "unnamed in libopencv_imgproc.so.4.6.0"),
    ("???:_PyEval_EvalFrameDefault'2 [/usr/bin/python3.11]", "_PyEval_EvalFrameDefault"),
])
def test_functions_have_the_same_name_on_every_machine(place, function):
    assert counts.function_of(place) == function


def test_no_piece_became_slower():
    slower = counts.compare(FIGURES, counts.count(), counts.made_with())
    assert not slower, "\n" + "\n".join(slower)
