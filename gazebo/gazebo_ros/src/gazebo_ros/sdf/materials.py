"""Materials of a package's own scripts, written for the renderer OGRE: the colours and the picture of each."""
import dataclasses
import math
import os
import re
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..world.devices import flag
from .document import NoFolders, found

#: Begins the name of a URDF material whose picture a script gives.
SCRIPTED = "script: "
COLORS = ("ambient", "diffuse", "specular", "emissive")
#: Keywords that open a part, or say nothing that is drawn differently here.
QUIET = {"technique", "pass", "texture_unit", "texture", "receive_shadows", "filtering",
         "max_anisotropy", "mipmap_bias", "tex_coord_set", "colour_op", "{", "}"}
PICTURES = (".png", ".jpg", ".jpeg", ".tga", ".bmp")


@dataclasses.dataclass(frozen=True)
class Material:
    """Colours as lists of 3 or 4 numbers from 0 to 1; None: the script does not say it."""
    ambient: typing.Optional[list] = None
    diffuse: typing.Optional[list] = None
    specular: typing.Optional[list] = None
    emissive: typing.Optional[list] = None
    texture: str = ""     #: name of the picture's file, as written
    scale: tuple = (1.0, 1.0)   #: width and height of the picture on the surface; below 1 it repeats
    scroll: tuple = (0.0, 0.0)  #: shares of the picture by which it lies further left and further up
    rotate: float = 0.0         #: degrees, about the middle of the picture
    address: str = "wrap"       #: behaviour beyond the picture's edges
    lit: bool = True      #: False: drawn in its own colour, without light and shadow
    ignored: tuple = ()   #: keywords

    def texture_transform(self) -> typing.Optional[numpy.ndarray]:
        """Returns (2, 3): (s, t) of the surface, right and down, to those of the picture; None: they are the same.

        Scale, then scroll, then rotate, scale and rotate about the middle: TextureUnitState::recalcTextureMatrix.
        """
        if (self.scale, self.scroll, self.rotate) == ((1.0, 1.0), (0.0, 0.0), 0.0):
            return None
        cos, sin = math.cos(math.radians(self.rotate)), math.sin(math.radians(self.rotate))
        turn = numpy.array(((cos, -sin), (sin, cos)))
        A = turn @ numpy.diag(1.0 / numpy.array(self.scale))
        return numpy.column_stack((A, 0.5 - A @ (0.5, 0.5) + turn @ self.scroll))


def read_script(text: str) -> typing.Dict[str, Material]:
    """dict of name -> Material. What is no material is passed over; of a material's passes the first counts, and of
    the texture units of this."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
    materials, name, depth, passes, units, unit_depth = {}, None, 0, 0, 0, 0
    for line in lines_of(text):
        words = line.split()
        keyword = words[0]
        if depth == 0 and keyword == "material" and len(words) > 1:
            name, passes, units = words[1], 0, 0
            parent = words[3] if len(words) > 3 and words[2] == ":" else ""
            materials[name] = materials.get(parent, Material())
        elif depth > 0 and name is not None:
            passes += keyword == "pass"
            if keyword == "texture_unit":
                units, unit_depth = units + 1, depth
            later = units > 1 and depth > unit_depth and materials[name].texture
            if passes < 2 and not later:
                materials[name] = told(materials[name], keyword, words[1:])
        depth += (keyword == "{") - (keyword == "}")
        name = None if depth == 0 and keyword == "}" else name
    return materials


def lines_of(text: str) -> typing.Iterator[str]:
    """Yields the non-empty lines, a brace on a line of its own."""
    for line in text.splitlines():
        for part in re.split(r"([{}])", line.partition("//")[0]):
            if part.strip():
                yield part.strip()


def told(material: Material, keyword: str, words: typing.List[str]) -> Material:
    """Returns the material with the setting of a line."""
    if keyword in COLORS:
        numbers = [each for each in map(number_of, words[:4])]
        count = 3 if keyword == "specular" and len(words) == 4 else len(words)  # its last number is the shininess
        if len(numbers) >= 3 and None not in numbers[:3]:
            return dataclasses.replace(material, **{keyword: numbers[:min(count, 4)]})
    if keyword == "texture" and words:
        return dataclasses.replace(material, texture=words[0].strip('"'))
    if keyword in ("scale", "scroll", "rotate"):
        numbers = [number_of(word) for word in words]
        if None not in numbers and len(numbers) == (1 if keyword == "rotate" else 2) and (
                keyword != "scale" or all(numbers)):
            return dataclasses.replace(material, **{keyword: tuple(numbers) if len(numbers) > 1 else numbers[0]})
    if keyword == "tex_address_mode" and words:
        return dataclasses.replace(material, address=" ".join(words))
    if keyword == "lighting" and words:
        return dataclasses.replace(material, lit=words[0] != "off")
    if keyword in QUIET or keyword in material.ignored:
        return material
    return dataclasses.replace(material, ignored=(*material.ignored, keyword))


def number_of(word: str) -> typing.Optional[float]:
    """Returns a finite number, None of anything else."""
    try:
        number = float(word)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def resolve_scripts(robot: ElementTree.Element, folders: NoFolders, warnings: typing.List[str]) -> None:
    """Replaces the names of material scripts by their content, in the <gazebo> tags of a URDF.

    Args:
        robot: root element.  folders: as World has them.  warnings: gets a line for each material of which something
        is ignored, and for each picture that is not there.
    """
    for gazebo in robot.findall("gazebo"):
        for look in gazebo.findall("visual"):
            material = look.find("material")
            script = None if material is None else material.find("script")
            name = "" if script is None else (script.findtext("name") or "").strip()
            places = [] if script is None else [found((uri.text or "").strip(), folders)
                                                for uri in script.findall("uri")]
            described = material_named(name, places)
            if described is None:
                continue  # one of Gazebo's own, or nowhere: the simulator says so
            material.remove(script)
            apply(described, name, material)
            if described.ignored:
                warnings.append("material '%s': %s: ignored" % (name, ", ".join(described.ignored)))
            if described.texture:
                picture = picture_named(described.texture, places)
                if picture:
                    set_picture(robot, gazebo.get("reference"), look.get("name"), name, picture)
                    transform = described.texture_transform()
                    if transform is not None:
                        ElementTree.SubElement(material, "texture_transform").text = " ".join(
                            repr(float(value)) for value in transform.ravel())
                        if set(described.address.split()) != {"wrap"}:
                            warnings.append("material '%s': tex_address_mode %s: its picture repeats" %
                                            (name, described.address))
                    for key in ("ambient", "diffuse"):  # the picture says it
                        for old in material.findall(key):
                            material.remove(old)
                    warnings += light_of_its_own(material, name)
                else:
                    warnings.append("material '%s': picture %s is not found: ignored" % (name, described.texture))


def light_of_its_own(material: ElementTree.Element, name: str) -> typing.List[str]:
    """Converts <emissive> of a material with a picture to Gazebo's result. Returns warnings.

    Gazebo multiplies the picture by the sum of all light that it gets and gives, 1 at most. A picture that gives 1 of
    every colour is therefore drawn in its own colours, in light and shadow. The simulator would add to the picture.
    """
    given = material.find("emissive")
    if given is None:
        return []
    material.remove(given)
    try:
        shares = [float(word) for word in (given.text or "").split()][:3]
    except ValueError:
        shares = []
    if len(shares) == 3 and min(shares) >= 1.0:
        lighting = material.find("lighting")
        (ElementTree.SubElement(material, "lighting") if lighting is None else lighting).text = "false"
    elif any(shares) and flag(material, "lighting", True):
        return ["material '%s': <emissive> beside a picture, less than 1 1 1: ignored" % name]
    return []


def material_named(name: str, places: typing.List[str]) -> typing.Optional[Material]:
    """Material of the first script in these files and folders that has it; None: nowhere."""
    for place in places if name else ():
        files = [place] if place.endswith(".material") else [
            os.path.join(place, file) for file in sorted(os.listdir(place)) if file.endswith(".material")
        ] if os.path.isdir(place) else []
        for file in files:
            with open(file, encoding="utf-8", errors="replace") as script:
                known = read_script(script.read())
            if name in known:
                return known[name]
    return None


def picture_named(name: str, places: typing.List[str]) -> str:
    """Whole path of a picture in these folders, or in textures/ beside them; "" if it is nowhere."""
    if not name.lower().endswith(PICTURES):
        return ""
    for place in places:
        folder = os.path.dirname(place) if place.endswith(".material") else place
        for candidate in (folder, os.path.join(os.path.dirname(folder), "textures")):
            if os.path.isfile(os.path.join(candidate, name)):
                return os.path.join(candidate, name)
    return ""


def apply(described: Material, name: str, material: ElementTree.Element) -> None:
    """Gives a <material> the colours that it does not state itself, and whether lights shine on it."""
    if not described.lit and material.find("lighting") is None:
        ElementTree.SubElement(material, "lighting").text = "false"
    for key in COLORS:
        color = getattr(described, key)
        if color is not None and material.find(key) is None:
            ElementTree.SubElement(material, key).text = " ".join(map(repr, color))


def set_picture(robot: ElementTree.Element, link: typing.Optional[str], visual: typing.Optional[str], name: str,
                picture: str) -> None:
    """Puts a picture on a <visual> of a link, or on all of them if it has no name."""
    for element in robot.findall("link"):
        for shown in element.findall("visual") if element.get("name") == link else ():
            if visual is None or shown.get("name") == visual:
                for old in shown.findall("material"):
                    shown.remove(old)
                made = ElementTree.SubElement(shown, "material", name=SCRIPTED + name)
                ElementTree.SubElement(made, "texture", filename="file://" + picture)


def painted(xml: str, folders: NoFolders) -> typing.Tuple[str, typing.List[str]]:
    """Returns a URDF with the content of its material scripts, and a list of their ignored parts."""
    if "<script" not in xml:
        return xml, []
    try:
        robot = ElementTree.fromstring(xml)
    except ElementTree.ParseError:
        return xml, []  # the reader reports the fault
    warnings = []
    resolve_scripts(robot, folders, warnings)
    return ElementTree.tostring(robot, encoding="unicode"), warnings


def with_transmissions(urdf: str, described: str) -> str:
    """A URDF with the <transmission>s that another one has of its joints."""
    if not described:
        return urdf
    robot = ElementTree.fromstring(urdf)
    joints = {joint.get("name") for joint in robot.findall("joint")}
    try:
        robot.extend(each for each in ElementTree.fromstring(described).findall("transmission")
                     if joints.issuperset(end.get("name") for end in each.findall("joint")))
    except ElementTree.ParseError:
        return urdf  # no URDF: then it has none
    return ElementTree.tostring(robot, encoding="unicode")
