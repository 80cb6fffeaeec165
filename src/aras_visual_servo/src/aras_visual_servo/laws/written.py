"""A law from a text that a user edits during a run, as in the editor of the live page.

    law = WrittenLaw(text)      # ParameterError: "law.py:7: NameError: ..."
    with law.tried():           # known by name here, and afterwards what was known before
        servo = Servo(kinematics, {**section, "law": law.name})
    law.put()                   # known by name from now on
"""

import contextlib
from typing import Dict, Iterator, Mapping, Optional, Type

from ..config.plugins import run_text
from ..ground.errors import ParameterError
from .base import LAWS, Law

#: Name of the module that a text is, of which errors name the lines.
MODULE = "law"


class WrittenLaw:
    """Attributes: name: of the law that the text registers.  text.  place: of its `_twist`, "law.py:LINE: ", or ""."""

    def __init__(self, text: str) -> None:
        """Runs the text. Raises ParameterError: an error in it with its line, or it registers not one law."""
        self.text = text
        before: Mapping[str, Type[Law]] = dict(LAWS)
        try:
            module = run_text(text, MODULE)
            added = {name: law for name, law in LAWS.items() if before.get(name) is not law}
        finally:
            _restore(before)
        self.name, self._law = _only(added, module.__name__, before)
        code = getattr(getattr(self._law, "_twist", None), "__code__", None)
        self.place = f"{MODULE}.py:{code.co_firstlineno}: " if code and code.co_filename == f"{MODULE}.py" else ""

    @contextlib.contextmanager
    def tried(self) -> Iterator[None]:
        """Makes the law known by its name in the block."""
        before = dict(LAWS)
        self.put()
        try:
            yield
        finally:
            _restore(before)

    def put(self) -> None:
        """Makes the law known by its name."""
        LAWS[self.name] = self._law


def _only(added, module, before):
    """(name, class) of the law that a text has registered."""
    if len(added) != 1:
        found = ", ".join(added) or "none"
        raise ParameterError(f"{MODULE}.py: found laws: {found}, allowed one, a class below @register_law(\"name\")")
    (name, law), = added.items()
    former: Optional[Type[Law]] = before.get(name)
    if not (isinstance(law, type) and issubclass(law, Law)):
        raise ParameterError(f"{MODULE}.py: found law {name}, which is no class derived from Law")
    if former is not None and former.__module__ != module:
        raise ParameterError(f"{MODULE}.py: found the name {name}, which another law has; allowed a name of its own")
    return name, law


def _restore(before: Mapping[str, Type[Law]]) -> None:
    now: Dict[str, Type[Law]] = dict(LAWS)
    for name in now.keys() - before.keys():
        del LAWS[name]
    for name, law in before.items():
        if now.get(name) is not law:
            LAWS[name] = law
