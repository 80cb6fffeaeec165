"""XML with the line of each element."""
import typing
import xml.etree.ElementTree as ElementTree
import xml.parsers.expat

from aras_visual_servo_sim import ModelError

from ..sdf.loose_xml import without_comments
from ..sdf.mend import text_of


class Lined:
    """A document. Attributes: path: of the file.  root: Element.  fault: text of its fault, else ""."""

    def __init__(self, path: str, text: typing.Optional[str] = None) -> None:
        """Args: text: of the document, None: it is read from the file."""
        self.path, self.fault = path, ""
        self.root: typing.Optional[ElementTree.Element] = None
        self._lines: typing.Dict[int, int] = {}
        self._open: typing.List[ElementTree.Element] = []
        try:
            text = text_of(path) if text is None else text
            try:
                self._parse(text)
            except xml.parsers.expat.ExpatError:
                self._parse(without_comments(text))
        except (ModelError, xml.parsers.expat.ExpatError) as error:
            self.fault = str(error)

    def where(self, element: ElementTree.Element) -> str:
        """Returns FILE:LINE of an element."""
        line = self._lines.get(id(element))
        return self.path if line is None else "%s:%d" % (self.path, line)

    def forget_lines(self) -> None:
        """Lets where() name the file alone."""
        self._lines.clear()

    def _parse(self, text: str) -> None:
        self.root, self._open = None, []
        self._lines.clear()
        self._parser = xml.parsers.expat.ParserCreate()
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._start, lambda _: self._open.pop()
        self._parser.CharacterDataHandler = self._data
        self._parser.Parse(text, True)

    def _start(self, tag: str, attributes: typing.Dict[str, str]) -> None:
        element = ElementTree.Element(tag, attributes)
        self._lines[id(element)] = self._parser.CurrentLineNumber
        if self._open:
            self._open[-1].append(element)
        elif self.root is None:
            self.root = element
        self._open.append(element)

    def _data(self, text: str) -> None:
        if self._open and not len(self._open[-1]):
            self._open[-1].text = (self._open[-1].text or "") + text
