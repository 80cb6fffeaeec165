"""Expands documents of SDF where there is no libsdformat: Debian 12 has it, Debian 13 has not.

It reads SDF 1.3 and newer, converts what World reads to the newest version, and replaces each <include> by what it
names. Without libsdformat's specification it names no unknown elements. It converts neither the noise of sensors of
SDF 1.5 nor a URDF, and it nests an <include merge="true"> instead of merging it.
"""
import math
import os
import typing
import xml.etree.ElementTree as ElementTree

from .loose_xml import parsed

Find = typing.Callable[[str], str]
OLDEST = 1, 3
TRUE = ("true", "1")
#: Counts of numbers that an element has; (6, 7): a pose with angles, or with a quaternion.
COUNTS = {"pose": (6, 7), "size": (2, 3), "radius": (1,), "length": (1,), "scale": (3,), "normal": (3,), "xyz": (3,),
          "mass": (1,), "ixx": (1,), "ixy": (1,), "ixz": (1,), "iyy": (1,), "iyz": (1,), "izz": (1,), "lower": (1,),
          "upper": (1,), "effort": (1,), "damping": (1,), "max_step_size": (1,), "real_time_update_rate": (1,),
          "gravity": (3,), "ambient": (3, 4), "diffuse": (3, 4), "specular": (3, 4), "emissive": (3, 4),
          "background": (3, 4)}
#: Counts that one parent narrows.
OF_PARENT: typing.Dict[typing.Tuple[str, str], typing.Tuple[int, ...]] = {
    ("box", "size"): (3,), ("plane", "size"): (2,), ("link", "gravity"): ()}
FREE_FORM = ("plugin",)  #: their content belongs to the plugin
REQUIRED = {"joint": ("parent", "child")}
Above = typing.Tuple[ElementTree.Element, ...]


def expanded(source: str, is_path: bool, find: Find) -> typing.Tuple[str, typing.List[str]]:
    """Returns a document in the newest version of SDF with its includes, and a line for each omitted part.

    Args: source: a path, or the document.  find: returns the path of a URI, "" if there is none.
    Raises: ValueError: no SDF, or one that is too old.
    """
    expander = Expander(find)
    path = model_file(source) if is_path else ""
    root = expander.read(path, None if is_path else source, ())
    return ElementTree.tostring(root, encoding="unicode"), expander.messages


class Expander:
    """Expands one document.

    Attributes: messages: a line for each thing that was left out.
    """

    def __init__(self, find: Find) -> None:
        self.messages: typing.List[str] = []
        self._find = find

    def read(self, path: str, text: typing.Optional[str], including: typing.Tuple[str, ...]) -> ElementTree.Element:
        """Returns the root of a document.

        Args: path: "" for none.  text: None: of the file.  including: paths of the documents that include it.
        """
        try:
            if text is None:
                with open(path, encoding="utf-8-sig", errors="replace") as file:
                    text = file.read()
            root = parsed(text)
        except (OSError, ValueError, ElementTree.ParseError) as error:
            raise ValueError("no SDF: Unable to read file[%s]: %s" % (path or "<data-string>", error)) from error
        if root.tag != "sdf":
            raise ValueError("no SDF: found <%s>, allowed without libsdformat is <sdf>" % root.tag)
        version = version_of(root.get("version", ""))
        if version < OLDEST:
            raise ValueError("no SDF: found version %s, allowed without libsdformat are 1.3 and newer" %
                             root.get("version"))
        self._check(root, (), path)
        convert(root, version)
        if path:
            locate(root, os.path.dirname(path))
        self._include(root, (*including, os.path.realpath(path)) if path else including)
        return root

    def _check(self, element: ElementTree.Element, above: Above, path: str) -> None:
        """Removes elements with a wrong count of numbers or a missing part."""
        for child in list(element):
            cause = fault_of(child, element)
            if cause:
                place = shown(child, (*above, element))
                self.messages.append("%s: %s: %s: left out" % (path or "the document", place, cause))
                element.remove(child)
            elif child.tag not in FREE_FORM:
                self._check(child, (*above, element), path)

    def _include(self, element: ElementTree.Element, including: typing.Tuple[str, ...]) -> None:
        """Puts documents in the place of the <include> of an element."""
        for k, child in reversed(list(enumerate(element))):
            if child.tag == "include":
                made = self._included(child, including)
                element[k:k + 1] = [] if made is None else [made]
            elif child.tag in ("world", "model"):
                self._include(child, including)

    def _included(self, include: ElementTree.Element,
                  including: typing.Tuple[str, ...]) -> typing.Optional[ElementTree.Element]:
        """Returns the model or light that an <include> names, as the include places it; None with a message."""
        uri = (include.findtext("uri") or "").strip()
        place = self._find(uri) if uri else ""
        path = model_file(place) if place else ""
        if not path:
            self.messages.append("Unable to find uri[%s]" % uri)
            return None
        if os.path.realpath(path) in including:
            self.messages.append("%s includes itself: left out" % path)
            return None
        root = self.read(path, None, including)
        made = next((each for each in root if each.tag in ("model", "light", "actor")), None)
        if made is None:
            self.messages.append("%s: found neither <model> nor <light>: left out" % path)
            return None
        if include.get("merge") in TRUE:
            self.messages.append("<include merge='true'> of %s: it becomes a model in the one around it" % uri)
        if include.findtext("name"):
            made.set("name", (include.findtext("name") or "").strip())
        for tag in ("pose", "static"):
            said = include.find(tag)
            if said is not None:
                for old in made.findall(tag):
                    made.remove(old)
                made.insert(0, said)
        made.extend(include.findall("plugin"))
        return made


def convert(root: ElementTree.Element, version: typing.Tuple[int, ...]) -> None:
    """Brings a document to the newest version (the specification's changes, sdformat.org/spec)."""
    for physics in root.iterfind("world/physics") if version < (1, 4) else ():
        for old, new in (("update_rate", "real_time_update_rate"), ("ode/solver/dt", "max_step_size"),
                         ("bullet/dt", "max_step_size")):
            found = physics.find(old)
            if found is not None:
                ElementTree.SubElement(physics, new).text = found.text
    for world in root.iterfind("world") if version < (1, 6) else ():
        gravity = world.find("physics/gravity")
        if gravity is not None and world.find("gravity") is None:
            world.append(gravity)
    if version < (1, 7):
        for pose in root.iter("pose"):
            if "frame" in pose.attrib:
                pose.set("relative_to", pose.attrib.pop("frame"))
        for model in root.iter("model"):
            for joint in model.findall("joint"):
                convert_axes(joint, by_default=version < (1, 5))


def convert_axes(joint: ElementTree.Element, by_default: bool) -> None:
    """Says by its attribute which frame an axis is given in.

    Args: by_default: in the model's where the axis does not say it.
    """
    for axis in (*joint.findall("axis"), *joint.findall("axis2")):
        said = axis.findtext("use_parent_model_frame")
        xyz = axis.find("xyz")
        if xyz is not None and (by_default if said is None else said.strip().lower() in TRUE):
            xyz.set("expressed_in", "__model__")
        for old in axis.findall("use_parent_model_frame"):
            axis.remove(old)


def locate(root: ElementTree.Element, folder: str) -> None:
    """Names files by their whole path where they lie beside the document."""
    for element in (*root.iter("uri"), *root.iter("filename")):
        named = (element.text or "").strip()
        path = os.path.normpath(os.path.join(folder, named))
        if named and "://" not in named and not os.path.isabs(named) and os.path.exists(path):
            element.text = path


def model_file(place: str) -> str:
    """Returns the document that a path names; of a folder, that of the newest version in its model.config, or ""."""
    if not os.path.isdir(place):
        return place
    for name in ("model.config", "manifest.xml"):
        try:
            config = ElementTree.parse(os.path.join(place, name)).getroot()
        except (OSError, ElementTree.ParseError):
            continue
        files = [each for each in config.iter("sdf") if (each.text or "").strip()]
        if files:
            newest = max(files, key=lambda each: version_of(each.get("version", "")))
            return os.path.join(place, (newest.text or "").strip())
    return ""


def version_of(text: str) -> typing.Tuple[int, ...]:
    """Returns the numbers of a version; (0,) for an invalid one."""
    try:
        return tuple(int(part) for part in text.split("."))
    except ValueError:
        return (0,)


def fault_of(element: ElementTree.Element, parent: ElementTree.Element) -> str:
    """Returns the fault of an element by itself, "" if there is none."""
    for tag in REQUIRED.get(element.tag, ()):
        if not (element.findtext(tag) or "").strip():
            return "found no <%s>" % tag
    allowed = OF_PARENT.get((parent.tag, element.tag), COUNTS.get(element.tag))
    words = (element.text or "").split()
    if not allowed or len(element) or not words or len(words) in allowed and all(map(is_number, words)):
        return ""
    return "found '%s', allowed are %s finite numbers" % (" ".join(words), " or ".join(map(str, allowed)))


def is_number(word: str) -> bool:
    """Returns whether a word is a finite number."""
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def shown(element: ElementTree.Element, above: Above) -> str:
    """Returns an element with the names of its ancestors: "model 'a', link 'b': <pose>"."""
    names = ["%s '%s'" % (each.tag, each.get("name")) for each in above if each.get("name") and each.tag != "world"]
    own = " name='%s'" % element.get("name") if element.get("name") else ""
    return (", ".join(names) + ": " if names else "") + "<%s%s>" % (element.tag, own)
