"""Copies of mesh files without their pictures, for meshes whose pictures cannot be read."""
import os
import re
import tempfile
import typing
import xml.etree.ElementTree as ElementTree

#: Lines of a material of an OBJ that name a picture.
PICTURES = re.compile(r"^\s*(map_|bump|disp|decal|refl|norm)", re.IGNORECASE)
WHITE = "1 1 1 1"


class _Folder:
    """A folder for the copies, which goes when the program ends."""

    def __init__(self) -> None:
        self._folder: typing.Optional[tempfile.TemporaryDirectory] = None
        self._known: typing.Dict[str, typing.Optional[str]] = {}

    def path(self, name: str) -> str:
        """Returns the path of a new file."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="gazebo_ros_")
        folder = tempfile.mkdtemp(dir=self._folder.name)
        return os.path.join(folder, name)

    def copy(self, path: str) -> typing.Optional[str]:
        """Returns the path of the copy of a mesh, None where there can be none."""
        if path not in self._known:
            writer = _WRITERS.get(os.path.splitext(path)[1].lower())
            try:
                self._known[path] = None if writer is None else writer(path, self.path(os.path.basename(path)))
            except (OSError, ElementTree.ParseError):
                self._known[path] = None
        return self._known[path]


def plain_copy(path: str) -> typing.Optional[str]:
    """Returns the path of a copy of a COLLADA or OBJ file without pictures, None of other files and of broken ones.

    The copies of one file are one; they go when the program ends.
    """
    return _FOLDER.copy(path)


def _plain_collada(path: str, target: str) -> str:
    document = ElementTree.parse(path)
    root = document.getroot()
    space = re.match(r"\{.*\}", root.tag)
    prefix = "" if space is None else space[0]
    if prefix:
        ElementTree.register_namespace("", prefix[1:-1])
    for parent in list(root.iter()):
        for child in list(parent):
            tag = child.tag[len(prefix):]
            pictured = child.find(prefix + "sampler2D") is not None or child.find(prefix + "surface") is not None
            if tag == "library_images" or tag == "newparam" and pictured:
                parent.remove(child)
            elif tag == "texture":
                color = ElementTree.Element(prefix + "color")
                color.text = WHITE
                parent.insert(list(parent).index(child), color)
                parent.remove(child)
    document.write(target, encoding="utf-8", xml_declaration=True)
    return target


def _plain_obj(path: str, target: str) -> str:
    lines, materials = [], []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if line.split()[:1] != ["mtllib"]:
                lines.append(line)
                continue
            place = os.path.join(os.path.dirname(path), line.split(None, 1)[1].strip())
            if os.path.isfile(place):
                with open(place, encoding="utf-8", errors="replace") as described:
                    materials += [each for each in described if not PICTURES.match(each)]
    if materials:
        lines.insert(0, "mtllib plain.mtl\n")
        with open(os.path.join(os.path.dirname(target), "plain.mtl"), "w", encoding="utf-8") as file:
            file.writelines(materials)
    with open(target, "w", encoding="utf-8") as file:
        file.writelines(lines)
    return target


_WRITERS: typing.Dict[str, typing.Callable[[str, str], str]] = {".dae": _plain_collada, ".obj": _plain_obj}
_FOLDER = _Folder()
