"""A law from a text is known only where it is tried or put, and whatever the text does is told with its line."""

import pytest

from aras_visual_servo import known_laws, ParameterError, WrittenLaw
from aras_visual_servo.laws.base import LAWS

TEXT = """
from dataclasses import dataclass
from typing import Optional
from aras_visual_servo import Law, register_law, setting

@dataclass(frozen=True)
class Settings:
    speed: Optional[float] = setting(None, above=0, help="Largest.")

@register_law("written", settings=Settings)
class Written(Law):
    def _twist(self, look, s, e):
        return [0.0] * 6
"""


def test_a_law_is_known_while_it_is_tried_and_once_it_is_put():
    before, law = dict(LAWS), WrittenLaw(TEXT)
    assert law.name == "written" and law.place == "law.py:12: " and dict(LAWS) == before
    with pytest.raises(KeyError), law.tried():
        assert "written" in known_laws()
        raise KeyError("in the block")
    assert dict(LAWS) == before
    try:
        law.put()
        newer = WrittenLaw(TEXT.replace("6", "7"))
        with newer.tried():
            assert LAWS["written"] is not newer and LAWS["written"].settings_class is not None
            inside = LAWS["written"]
        assert LAWS["written"] is not inside and known_laws().count("written") == 1
    finally:
        del LAWS["written"]


@pytest.mark.parametrize("text, said", [
    ("x = (", "^law.py:1: SyntaxError"), ("\n\nraise SystemExit(1)", "^law.py:3: SystemExit"),
    (TEXT + "\n1 / 0", "^law.py:15: ZeroDivisionError"),
    (TEXT.replace("above=0, ", "above=0, unknown=1, "), "^law.py:8: TypeError")])
def test_an_error_of_the_text_has_its_line_and_leaves_no_law(text, said):
    before = dict(LAWS)
    with pytest.raises(ParameterError, match=said):
        WrittenLaw(text)
    assert dict(LAWS) == before
