"""Lets xacro take tags without the prefix `xacro:`, as it did from ROS Indigo to Melodic, with a warning that has file
and line. xacro 2 passes them over, and then says that a property is not defined or makes a document without the links
of a macro. Documents that have such tags may also call macros that nobody defines, and define properties without a
name, which xacro of ROS Indigo passed over."""
import io
import os
import sys
import typing
import xml.dom.minidom
import xml.parsers.expat

import xacro

KEYWORDS = ("arg", "element", "attribute", "if", "include", "insert_block", "macro", "property", "unless")
#: Names of tags in robot descriptions and SDF. They are never taken as macro calls.
OWN_TAGS = frozenset(
    "actuator axis box calibration camera child collision color cylinder dynamics gazebo geometry hardwareInterface "
    "inertia inertial joint limit link mass material mechanicalReduction mesh mimic origin parent plugin ray robot "
    "safety_controller sensor sphere texture transmission type verbose visual".split())
#: Tags of other readers. Tags in them never count as xacro's.
FOREIGN = ("plugin", "sdf", "world")
FIX = ("find . -iname '*.xacro' | xargs sed -i "
       "'s#<\\([/]\\?\\)\\(if\\|unless\\|include\\|arg\\|property\\|macro\\|insert_block\\)\\b#<\\1xacro:\\2#g'")


class Notes:
    """Collects where tags without the prefix stand, and says it once for each file."""

    def __init__(self) -> None:
        self._found, self._passed = {}, []

    def is_old(self) -> bool:
        """Whether tags without the prefix have been met."""
        return bool(self._found)

    def pass_over(self, node: xml.dom.minidom.Element, what: str) -> None:
        """Removes an element, and notes it. Args: what: its fault."""
        self._passed.append("%s:%d: <%s>: %s: passed over, as until ROS Indigo" % (*place(node), node.tagName, what))
        xacro.replace_node(node, by=None)

    def add(self, file: str, line: int, tag: str) -> None:
        """Notes a tag. Args: line: from 1; 0 where it is not known."""
        self._found.setdefault(file, {}).setdefault(tag, []).append(line)

    def lines(self) -> typing.List[str]:
        """Returns a line of text for each file, and the command that mends them last."""
        told = ["%s: tags without the prefix xacro: are deprecated, line %s" %
                (file, ", ".join("%d <%s>" % (line, tag) for line, tag in
                                 sorted((line, tag) for tag, lines in tags.items() for line in lines)))
                for file, tags in self._found.items()]
        fix = "xacro of ROS Noetic does not read such tags. This adds the prefix, but for calls of macros:\n  " + FIX
        return [*told, fix, *self._passed] if told else []


def place(node: xml.dom.minidom.Element) -> typing.Tuple[str, int]:
    """Returns the file of an element, and its line from 1, 0 where it is not known."""
    return getattr(node, "xacro_place", (xacro.filestack[-1] if xacro.filestack else "?", 0))


def line_numbers(text: typing.Union[str, bytes]) -> typing.List[int]:
    """Returns the lines of all elements of a document, in its order, from 1."""
    lines, parser = [], xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = lambda *_: lines.append(parser.CurrentLineNumber)
    parser.Parse(text, True)
    return lines


def add_prefixes(document: xml.dom.minidom.Document, text: typing.Union[str, bytes], file: str, notes: Notes) -> None:
    """Gives the keywords of a document of a robot their prefix. Args: text: of the document, for line numbers."""
    root = document.documentElement
    if root.tagName != "robot":
        return
    for node, line in zip([root, *root.getElementsByTagName("*")], line_numbers(text)):
        node.xacro_place = (file, line)
        if node.tagName in KEYWORDS and not is_foreign(node):
            notes.add(file, line, node.tagName)
            node.tagName = node.nodeName = "xacro:" + node.tagName


def is_foreign(node: xml.dom.minidom.Element) -> bool:
    """Whether an element stands in one that xacro knows nothing about."""
    node = node.parentNode
    while node is not None and node.nodeType == xml.dom.Node.ELEMENT_NODE:
        if node.tagName in FOREIGN:
            return True
        node = node.parentNode
    return False


def install(notes: Notes) -> None:
    """Lets the library xacro take tags without the prefix, and notes them."""
    parse, call, grab = xacro.parse, xacro.handle_macro_call, xacro.grab_property

    def parsed(inp: typing.Any, filename: typing.Optional[str] = None) -> xml.dom.minidom.Document:
        path = filename
        if inp is None:
            path = os.path.join(xacro.root_dir or "", filename)
            if not os.path.isfile(path):
                return parse(inp, filename)  # reports the fault
            with open(path, "rb") as stream:
                text = stream.read()
            inp = io.BytesIO(text)
        elif isinstance(inp, str):
            text = inp
        else:
            return parse(inp, filename)
        document = parse(inp, filename)
        add_prefixes(document, text, path or "the document", notes)
        return document

    def called(node: xml.dom.minidom.Element, macros: typing.Any, symbols: typing.Any) -> bool:
        name = node.tagName
        if ":" not in name and name not in OWN_TAGS and name in macros:
            notes.add(*place(node), name)
            node.tagName = node.nodeName = "xacro:" + name
        elif notes.is_old() and name.startswith("xacro:") and name != "xacro:call":
            try:
                xacro.resolve_macro(name[len("xacro:"):], macros, symbols)
            except KeyError:
                notes.pass_over(node, "there is no such macro")
                return True
        return call(node, macros, symbols)

    def grabbed(element: xml.dom.minidom.Element, table: typing.Any) -> None:
        name = element.getAttribute("name")
        if notes.is_old() and not xacro.is_valid_name(str(xacro.eval_text(name, table))):
            notes.pass_over(element, "found the name '%s', which no property can have" % name)
        else:
            grab(element, table)

    xacro.parse, xacro.handle_macro_call, xacro.grab_property = parsed, called, grabbed


def main() -> None:
    """The program xacro."""
    notes = Notes()
    install(notes)
    try:
        xacro.main()
    finally:
        for line in notes.lines():
            print("xacro: " + line, file=sys.stderr)
