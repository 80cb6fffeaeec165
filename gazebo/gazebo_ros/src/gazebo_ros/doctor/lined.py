"""XML with the line of each element."""
import xml.etree.ElementTree as ElementTree
import xml.parsers.expat


class Lined:
    """A document. Attributes: path: of the file.  root: Element.  fault: what is wrong with it, "" for nothing."""

    def __init__(self, path, text=None):
        """Args: text: of the document, None: it is read from the file."""
        self.path, self.root, self.fault, self._lines, self._open = path, None, "", {}, []
        parser = xml.parsers.expat.ParserCreate()
        parser.StartElementHandler, parser.EndElementHandler = self._start, lambda _: self._open.pop()
        parser.CharacterDataHandler = self._data
        self._parser = parser
        try:
            if text is None:
                with open(path, "rb") as file:
                    text = file.read()
            parser.Parse(text, True)
        except (OSError, xml.parsers.expat.ExpatError) as error:
            self.fault = str(error)

    def where(self, element):
        """Returns FILE:LINE of an element."""
        line = self._lines.get(id(element))
        return self.path if line is None else "%s:%d" % (self.path, line)

    def forget_lines(self):
        """Lets where() name the file alone."""
        self._lines.clear()

    def _start(self, tag, attributes):
        element = ElementTree.Element(tag, attributes)
        self._lines[id(element)] = self._parser.CurrentLineNumber
        if self._open:
            self._open[-1].append(element)
        elif self.root is None:
            self.root = element
        self._open.append(element)

    def _data(self, text):
        if self._open and not len(self._open[-1]):
            self._open[-1].text = (self._open[-1].text or "") + text
