"""Materials of Gazebo's own script that have a picture, as plain colours of ours in the same tone.

The pictures belong to Gazebo and are not there. The plain colours (Gazebo/Red, ...) are read by the simulator."""
import typing
import xml.etree.ElementTree as ElementTree

#: Red, green, blue, 0 .. 1, by the name behind `Gazebo/`.
COLORS = {
    "Wood": (0.55, 0.39, 0.22), "WoodFloor": (0.52, 0.36, 0.2), "WoodPallet": (0.68, 0.55, 0.38),
    "Bricks": (0.6, 0.25, 0.2), "CeilingTiled": (0.85, 0.85, 0.82), "PaintedWall": (0.8, 0.77, 0.7),
    "Road": (0.25, 0.25, 0.25), "Residential": (0.5, 0.48, 0.45), "Tarmac": (0.22, 0.22, 0.23),
    "Motorway": (0.28, 0.28, 0.28), "Pedestrian": (0.6, 0.58, 0.55), "Footway": (0.6, 0.58, 0.55),
    "Grass": (0.25, 0.45, 0.15), "Runway": (0.3, 0.3, 0.3), "Rockwall": (0.45, 0.42, 0.38),
    "RustySteel": (0.45, 0.25, 0.15), "Chrome": (0.75, 0.77, 0.8), "BumpyMetal": (0.6, 0.6, 0.62),
    "Steel": (0.6, 0.61, 0.63), "CloudySky": (0.6, 0.7, 0.85), "GrassFloor": (0.25, 0.45, 0.15),
    "EpingoRed": (0.75, 0.1, 0.1), "PioneerBody": (0.75, 0.1, 0.1), "Pioneer2Body": (0.75, 0.1, 0.1),
    "LightWood": (0.76, 0.6, 0.42), "WoodTile": (0.6, 0.45, 0.3), "Fish": (0.8, 0.5, 0.2),
    "Eyes": (0.9, 0.9, 0.9), "TurquoiseGlowOutline": (0.0, 1.0, 1.0), "BlackTransparent": (0.0, 0.0, 0.0),
    "BlueTransparent": (0.0, 0.0, 1.0), "GreenTransparent": (0.0, 1.0, 0.0), "RedTransparent": (1.0, 0.0, 0.0),
    "YellowTransparent": (1.0, 1.0, 0.0), "GreyTransparent": (0.5, 0.5, 0.5), "OrangeTransparent": (1.0, 0.44, 0.0),
    "DarkOrangeTransparent": (0.6, 0.27, 0.0), "DarkMagentaTransparent": (0.6, 0.0, 0.6),
    "LightOn": (0.0, 1.0, 0.0), "LightOff": (1.0, 0.0, 0.0), "BlueLaser": (0.0, 0.0, 1.0),
    "Gray": (0.7, 0.7, 0.7), "DarkYellow": (0.7, 0.7, 0.0), "Brown": (0.4, 0.25, 0.1),
    "Indigo": (0.33, 0.0, 0.5), "GaussianCameraNoise": (0.5, 0.5, 0.5), "ShadowCaster": (0.5, 0.5, 0.5)}
SEEN_THROUGH = "Transparent"  #: ends the names of materials that are half transparent
TRANSPARENCY = 0.5


def color_of(name: str) -> typing.Optional[str]:
    """Returns the colour of a material of Gazebo's, as a text of four numbers, or None: it has none here."""
    scope, _, name = name.strip().rpartition("/")
    return "%g %g %g 1" % COLORS[name] if scope == "Gazebo" and name in COLORS else None


def replace_pictures(robot: ElementTree.Element) -> typing.List[str]:
    """Puts colours in the place of the names of such materials in the <gazebo> tags of a URDF.

    Returns: a line for each material.
    """
    replaced = {}
    for gazebo in robot.findall("gazebo"):
        for plain in gazebo.findall("material"):
            color = color_of(plain.text or "")
            if color is not None:
                gazebo.remove(plain)
                look = ElementTree.SubElement(gazebo, "visual")
                give(look, ElementTree.SubElement(look, "material"), plain.text.strip(), color)
                replaced[plain.text.strip()] = color
        for look in gazebo.findall("visual"):
            for script in look.findall("material/script"):
                name = (script.findtext("name") or "").strip()
                color = color_of(name)
                if color is not None:
                    look.find("material").remove(script)
                    give(look, look.find("material"), name, color)
                    replaced[name] = color
    return ["material '%s': its picture is not there, it is the colour %s" % item for item in replaced.items()
            if not item[0].endswith(SEEN_THROUGH)]


def give(look: ElementTree.Element, material: ElementTree.Element, name: str, color: str) -> None:
    """Gives a <material> the colours that it does not state, and its <visual> the transparency."""
    for key in ("ambient", "diffuse"):
        if material.find(key) is None:
            ElementTree.SubElement(material, key).text = color
    if name.endswith(SEEN_THROUGH) and look.find("transparency") is None:
        ElementTree.SubElement(look, "transparency").text = repr(TRANSPARENCY)
