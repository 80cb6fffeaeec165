"""Repairs documents of SDF for libsdformat: parts that it rejects are repaired or removed, by name.

libsdformat says in which line the element is that it refuses. Each element is on a line of its own here, so that the
line tells the element.
"""
import os
import re
import tempfile
import typing
import xml.etree.ElementTree as ElementTree
import xml.parsers.expat

from aras_visual_servo_sim import ModelError

from ..faults import LEFT_OUT, REFUSED, told
try:
    from .. import _sdf  # type: ignore[attr-defined]  # is compiled where there is libsdformat
except ImportError:
    from . import expander as _sdf
from .loose_xml import parsed, readable

#: A time of a saved <state> without its nanoseconds, which Gazebo's SDF reads and libsdformat 12 does not.
SECONDS = re.compile(r"(<(sim_time|real_time|wall_time)>\s*\d+)(\s*</\2>)")
#: In names that Gazebo saves (a link `arm::hand` of a model that was included); libsdformat would make models of them.
SCOPE, STAND_IN = "::", "\u2237"
NAMED = ("model", "link", "joint", "frame", "visual", "collision", "sensor", "light", "plugin", "world")
#: Attributes and tags that refer to a name.
REFERRING = ("name", "relative_to", "frame", "attached_to", "expressed_in", "canonical_link", "placement_frame")
ENDS = ("parent", "child")
RESERVED, RESERVED_INSTEAD = "world", "world_link"  #: of a link; joints mean the world itself by it
REPLACED = "\ufffd"  #: stands for bytes that are no text, as in comments of another encoding
VERSION = re.compile(r"^1\.\d+$")
NEWEST_READ_BY_ALL = "1.6"
PLACE = re.compile(r"Error reading element <(?P<tag>[^>]*)> \([^()]*:(?P<line>\d+)\)")
FILE = re.compile(r"Unable to read file\[(?P<file>[^\]]*)\]")
MOST_FAULTS = 200  #: of one document
Find = typing.Callable[[str], str]


class Reader:
    """Reads one document, with the files that it includes.

    Attributes: warnings: a line for each fault and for each thing that was left out.
    """

    def __init__(self, find: Find) -> None:
        """Args: find: returns the path of a URI, "" if there is none."""
        self.warnings: typing.List[str] = []
        self._find, self._folder = find, ""
        self._texts: typing.Dict[str, str] = {}   # of files that are included, as libsdformat reads them
        self._copies: typing.Dict[str, str] = {}  # of folders
        self._places: typing.Dict[str, str] = {}  # place of a copy -> its original

    def expanded(self, source: str, is_path: bool) -> ElementTree.Element:
        """Returns the root of a document in the newest version of SDF, with its includes in place.

        Raises: ModelError: names the file, if there is one, and its fault.
        """
        with tempfile.TemporaryDirectory(prefix="gazebo_ros_") as folder:
            self._folder = folder
            _, (text, messages) = self._read(source if is_path else "", None if is_path else source)
        for place, original in self._places.items():
            text = text.replace(place, original)
            messages = [message.replace(place, original) for message in messages]
        self.warnings += messages
        return parsed(text.replace(STAND_IN, SCOPE))

    def _read(self, path: str, text: typing.Optional[str]) -> typing.Tuple[str, typing.Tuple[str, typing.List[str]]]:
        """Returns the text for libsdformat, and its results: the expanded text and its messages.

        Args: path: "" for none.  text: None: of the file.
        """
        name = path or "the document"
        original = text_of(path) if text is None else text
        text = self._tidy(original, name)
        for _ in range(MOST_FAULTS):
            try:
                place = path if text == original else self._copy(path, text) if path else ""
                return text, _sdf.expanded(*((place, True) if path else (text, False)), self._located)
            except ValueError as error:
                text = self._without(text, str(error).replace(STAND_IN, SCOPE), name)
        raise refused(name, "more than %d faults" % MOST_FAULTS)

    def _without(self, text: str, message: str, name: str) -> str:
        """Returns the text without the element that a message of libsdformat is about. Raises: ModelError."""
        inner = FILE.search(message)
        included = inner and self._original(inner["file"])
        if included and included not in self._texts and os.path.isfile(included):
            self._texts[included] = ""  # is being mended: a file that includes itself ends here
            self._texts[included], _ = self._read(included, None)
            self._copies.clear()
            return text
        place = PLACE.search(message)
        if place is None:
            raise refused(name, message)
        if text != lined(text):
            return lined(text)  # then the line tells the element
        root, elements = by_line(text)
        element, above = elements.get(int(place["line"]), (None, ()))
        if element is None or not above:
            raise refused(name, message)
        cause = message.replace("no SDF: ", "", 1).partition(": Error reading")[0].partition(" (<data-string>")[0]
        is_value = cause.startswith("Error reading")
        self.warnings.append(told("element", "%s: %s" % (name, shown(element, *above)),
                                  "'%s'" % (element.text or "").strip() if is_value else cause,
                                  "SDF's default" if is_value else LEFT_OUT))
        above[0].remove(element)
        return lined(ElementTree.tostring(root, encoding="unicode"))

    # --- files

    def _located(self, uri: str) -> str:
        """Returns the path of a URI; for a folder with repaired files, a copy with these."""
        path = self._find(uri)
        if not os.path.isdir(path):
            return path
        if path not in self._copies:
            texts = {}
            for file in sorted(os.listdir(path)):
                whole = os.path.join(path, file)
                if file.endswith((".sdf", ".world")) and os.path.isfile(whole):
                    text = self._texts.get(whole) or self._tidy(text_of(whole), whole)
                    if text != text_of(whole):
                        texts[file] = text
            self._copies[path] = self._copy_folder(path, texts) if texts else path
        return self._copies[path]

    def _copy(self, path: str, text: str) -> str:
        """Path of a copy of a file with another text, beside the same files."""
        folder, name = os.path.split(os.path.abspath(path))
        return os.path.join(self._copy_folder(folder, {name: text}), name)

    def _copy_folder(self, folder: str, texts: typing.Dict[str, str]) -> str:
        """Creates a folder of links to the content of another one, with these texts in place of its files."""
        made = tempfile.mkdtemp(dir=self._folder)
        self._places[made] = folder
        for each in os.listdir(folder):
            if each not in texts:
                os.symlink(os.path.join(folder, each), os.path.join(made, each))
        for name, text in texts.items():
            with open(os.path.join(made, name), "w", encoding="utf-8") as file:
                file.write(text)
        return made

    def _original(self, path: str) -> str:
        for place, original in self._places.items():
            if path.startswith(place + os.sep):
                return original + path[len(place):]
        return path

    # --- checks without libsdformat

    def _tidy(self, text: str, name: str) -> str:
        """Returns the same text, or one with the version, the names and the times that libsdformat wants.

        Raises: ModelError: no XML.
        """
        text = SECONDS.sub(r"\1 0\3", text)
        try:
            root = parsed(text)
        except (ElementTree.ParseError, ValueError) as error:
            raise refused(name, "no XML: %s" % error) from error
        changed = self._tidy_version(root, name) or REPLACED in text
        changed = self._tidy_names(root, name) or changed
        for pose in root.iter("pose"):
            if pose.get("frame") == "":  # as Gazebo saves it: the frame that the element stands in
                del pose.attrib["frame"]
                changed = True
        return ElementTree.tostring(root, encoding="unicode") if changed else text

    def _tidy_version(self, root: ElementTree.Element, name: str) -> bool:
        if root.tag == "gazebo" and root.get("version"):  # SDF 1.0 to 1.2
            root.tag = "sdf"
            return True
        if root.tag != "sdf" or VERSION.match(root.get("version", "")):
            return False
        self.warnings.append(told("version", name + ": <sdf>", "the version '%s'" % root.get("version", "")))
        root.set("version", NEWEST_READ_BY_ALL)
        return True

    def _tidy_names(self, root: ElementTree.Element, name: str) -> bool:
        scoped, changed = set(), False
        for parent in root.iter():
            for k, element in enumerate(parent):
                if element.tag not in NAMED or parent.tag not in (*NAMED, "sdf"):
                    continue
                found, made = "", ""
                if not element.get("name", "").strip():
                    found = "no name"
                    made = element.get("filename", "").rpartition("/")[2] or "%s_%d" % (element.tag, k + 1)
                elif element.tag == "link" and element.get("name") == RESERVED:
                    found, made = "a reserved name", RESERVED_INSTEAD
                elif element.tag == "model" and parent.tag in ("world", "sdf") and SCOPE in element.get("name", ""):
                    found, made = SCOPE, element.get("name", "").replace(SCOPE, "_")
                if found:
                    self.warnings.append(told("name", "%s: %s" % (name, shown(element, parent)), found, made))
                    element.set("name", made)
                    changed = True
                if SCOPE in element.get("name", ""):
                    scoped.add(element.get("name"))
        if not scoped:
            return changed
        for element in root.iter():
            for key in REFERRING:
                if element.get(key) in scoped:
                    element.set(key, element.get(key, "").replace(SCOPE, STAND_IN))
            if element.tag in ENDS and (element.text or "").strip() in scoped:
                element.text = (element.text or "").strip().replace(SCOPE, STAND_IN)
        return True


def text_of(path: str) -> str:
    """Returns the text of a file. Raises: ModelError: it cannot be read."""
    try:
        with open(path, "rb") as file:
            data = file.read()
        coding = re.match(rb"<\?xml[^>]*encoding=[\"']([\w-]+)", data)
        text = data.decode(coding[1].decode() if coding else "utf-8-sig", errors="replace")
    except (OSError, LookupError) as error:
        raise refused(path, str(error)) from error
    return re.sub(r"^\s*<\?xml.*?\?>", "", text)


def refused(name: str, cause: str) -> ModelError:
    """Returns the error of a document that cannot be read."""
    return ModelError("%s%s: %s" % (REFUSED, name, cause))


def shown(element: ElementTree.Element, *above: ElementTree.Element) -> str:
    """Returns an element with its ancestors, for a warning: "model 'a', link 'b': <pose>".

    Args: above: its ancestors, the nearest first.
    """
    named = ["%s '%s'" % (each.tag, each.get("name")) for each in reversed(above)
             if each.tag in NAMED and each.tag != "world"]
    own = " name='%s'" % element.get("name") if element.get("name") else ""
    return (", ".join(named) + ": " if named else "") + "<%s%s>" % (element.tag, own)


#: Line -> the element that begins there, and its ancestors, the nearest first.
Lines = typing.Dict[int, typing.Tuple[ElementTree.Element, typing.Tuple[ElementTree.Element, ...]]]


def by_line(text: str) -> typing.Tuple[ElementTree.Element, Lines]:
    """Returns the root of a document and its elements by the line in which they begin; the last one of a line."""
    text = readable(text)
    root = ElementTree.fromstring(text)
    above: typing.Dict[ElementTree.Element, typing.Tuple[ElementTree.Element, ...]] = {root: ()}
    for parent in root.iter():
        above.update((child, (parent, *above[parent])) for child in parent)
    numbers: typing.List[int] = []
    parser = xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = lambda *_: numbers.append(parser.CurrentLineNumber)
    parser.Parse(text, True)
    return root, {line: (element, above[element]) for line, element in zip(numbers, root.iter())}


def lined(text: str) -> str:
    """Returns a document with each element on a line of its own."""
    root = parsed(text)
    for element in root.iter():
        if len(element) and not (element.text or "").strip():
            element.text = "\n"
        element.tail = "\n"
    return ElementTree.tostring(root, encoding="unicode")
