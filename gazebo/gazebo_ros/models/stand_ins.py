#!/usr/bin/env python3
"""Writes stand-ins for models of Gazebo's database: python3 stand_ins.py FOLDER.

Worlds include them by name, and the database is not there. Sizes, masses and origins are those of the models of that
name; the shapes are plain and the colours our own. A model is a folder with model.sdf and model.config."""
import math
import pathlib
import sys
import typing

#: Shape, sizes, position of its middle, colour.
Part = typing.Tuple[str, typing.Sequence[float], typing.Sequence[float], typing.Sequence[float]]
WOOD, GREY, WHITE = (0.55, 0.39, 0.22), (0.7, 0.7, 0.7), (0.95, 0.95, 0.95)
RED, BROWN, ORANGE, BRICK = (0.75, 0.1, 0.1), (0.66, 0.5, 0.3), (0.95, 0.4, 0.05), (0.6, 0.25, 0.2)
METAL, GREEN = (0.5, 0.52, 0.55), (0.15, 0.35, 0.2)


def box(size: typing.Sequence[float], at: typing.Sequence[float], color: typing.Sequence[float]) -> Part:
    """Returns a part: edges [m], position of its middle [m] and colour (0 .. 1)."""
    return "box", tuple(size), tuple(at), color


def cylinder(radius: float, length: float, at: typing.Sequence[float], color: typing.Sequence[float]) -> Part:
    """Returns a part that stands upright."""
    return "cylinder", (radius, length), tuple(at), color


def ball(radius: float, at: typing.Sequence[float], color: typing.Sequence[float]) -> Part:
    """Returns a part."""
    return "sphere", (radius,), tuple(at), color


def cube(edge: float, color: typing.Sequence[float]) -> typing.List[Part]:
    """Returns the parts of a cube that stands on its origin."""
    return [box((edge,) * 3, (0, 0, edge / 2), color)]


LEGS = [cylinder(0.02, 1.0, (x, y, 0.5), GREY) for x in (0.68, -0.68) for y in (0.38, -0.38)]
SHELVES = [box((0.9, 0.01, 1.2), (0, 0.005, 0.6), WOOD),
           *(box((0.02, 0.4, 1.2), (x, -0.195, 0.6), WOOD) for x in (0.45, -0.45)),
           box((0.88, 0.4, 0.06), (0, -0.195, 0.03), WOOD),
           *(box((0.88, 0.4, 0.02), (0, -0.195, z), WOOD) for z in (0.43, 0.8, 1.19))]
CABINET = [*(box((0.45, 0.45, 0.02), (0, 0, z), WOOD) for z in (0.01, 0.51, 1.01)),
           box((0.02, 0.45, 1.02), (0.235, 0, 0.51), WOOD),
           *(box((0.45, 0.02, 1.02), (0, y, 0.51), WOOD) for y in (0.235, -0.235))]
BLOCK = [*(box((0.43495, 0.0339, 0.2032), (0, y, 0.1016), GREY) for y in (-0.08465, 0.08465)),
         *(box((0.0339, 0.1354, 0.203), (x, 0, 0.1016), GREY) for x in (0.18625, 0.0, -0.18625))]
BARRIER = [box((4.06542, 0.3063, 1.143), (0, 0, 0.5715), GREY),
           box((4.06542, 0.8107, 0.064516), (0, 0, 0.032258), GREY)]
#: Mass [kg], 0: it is static; and the parts.
MODELS = {
    "table": (0, [box((1.5, 0.8, 0.03), (0, 0, 1.0), WOOD), *LEGS]),
    "cafe_table": (0, [box((0.913, 0.913, 0.04), (0, 0, 0.755), WOOD), box((0.042, 0.042, 0.74), (0, 0, 0.37), METAL),
                       box((0.56, 0.56, 0.04), (0, 0, 0.02), METAL)]),
    "table_marble": (0, [box((0.8, 1.5, 0.04), (0, 0, 0.58), WHITE), box((0.7, 1.3, 0.56), (0, 0, 0.28), GREY)]),
    "bookshelf": (0, SHELVES),
    "cabinet": (0, CABINET),
    "cardboard_box": (20.0, [box((0.5, 0.4, 0.3), (0, 0, 0.15), BROWN)]),
    "cinder_block": (17.0, BLOCK),
    "coke_can": (0.39, [cylinder(0.033, 0.12, (0, 0, 0), RED)]),
    "beer": (0.39, [cylinder(0.055, 0.23, (0, 0, 0), GREEN)]),
    "bowl": (0.1, [cylinder(0.098, 0.035, (0, 0, 0.0175), WHITE)]),
    "cricket_ball": (0.16, [ball(0.0375, (0, 0, 0.0375), RED)]),
    "construction_cone": (1.0, [box((0.45, 0.45, 0.04), (0, 0, 0.02), ORANGE),
                                cylinder(0.16, 0.25, (0, 0, 0.165), ORANGE), cylinder(0.11, 0.25, (0, 0, 0.415), WHITE),
                                cylinder(0.06, 0.25, (0, 0, 0.665), ORANGE)]),
    "construction_barrel": (10.0, [cylinder(0.3, 1.06, (0, 0, 0.53), ORANGE)]),
    "jersey_barrier": (4000.0, BARRIER),
    "brick_box_3x1x3": (0, [box((3.0, 1.0, 3.0), (0, 0, 1.5), BRICK)]),
    "grey_wall": (0, [box((2.8, 7.5, 0.2), (0, 0, 0), GREY)]),
    "wood_cube_10cm": (0.5, cube(0.1, WOOD)),
    "wood_cube_7_5cm": (0.2109375, cube(0.075, WOOD)),
    "wood_cube_5cm": (0.0625, cube(0.05, WOOD)),
    "wood_cube_2_5cm": (0.0078125, cube(0.025, WOOD)),
    "wood_block_10_2_1cm": (0.0125, [box((0.1, 0.025, 0.01), (0, 0, 0.005), WOOD)]),
    "unit_box": (1.0, cube(1.0, GREY)),
    "unit_cylinder": (1.0, [cylinder(0.5, 1.0, (0, 0, 0.5), GREY)]),
    "unit_sphere": (1.0, [ball(0.5, (0, 0, 0.5), GREY)]),
}
#: The board under calibrated cameras; saved worlds name its mesh by this path, too.
BOARD, BOARD_MESH = "checkerboard_plane", "meshes/checkerboard_plane.dae"
#: Beginnings of the names of models whose link has its origin in the middle of the shape, above that of the model.
IN_THE_MIDDLE = ("wood_", "cricket_ball", "unit_", "brick_box")
TAGS = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}


def inertia(part: Part, mass_kg: float) -> typing.Tuple[float, float, float]:
    """Returns the moments (3,) of a solid part about its middle [kg m^2]."""
    shape, sizes = part[:2]
    if shape == "sphere":
        return (0.4 * mass_kg * sizes[0] ** 2,) * 3
    if shape == "cylinder":
        radius, length = sizes
        across = mass_kg * (3.0 * radius ** 2 + length ** 2) / 12.0
        return across, across, 0.5 * mass_kg * radius ** 2
    x, y, z = (size ** 2 for size in sizes)
    return mass_kg * (y + z) / 12.0, mass_kg * (x + z) / 12.0, mass_kg * (x + y) / 12.0


def volume(part: Part) -> float:
    """Returns [m^3]."""
    shape, sizes = part[:2]
    if shape == "sphere":
        return 4.0 / 3.0 * math.pi * sizes[0] ** 3
    return math.pi * sizes[0] ** 2 * sizes[1] if shape == "cylinder" else sizes[0] * sizes[1] * sizes[2]


def inertial_of(mass_kg: float, parts: typing.Sequence[Part]) -> str:
    """Returns <inertial> of parts of one density."""
    whole = sum(map(volume, parts))
    shares = [mass_kg * volume(part) / whole for part in parts]
    centre = [sum(share * part[2][k] for share, part in zip(shares, parts)) / mass_kg for k in range(3)]
    moments = [0.0, 0.0, 0.0]
    for share, part in zip(shares, parts):
        arm = [part[2][k] - centre[k] for k in range(3)]
        for k, moment in enumerate(inertia(part, share)):
            moments[k] += moment + share * sum(arm[j] ** 2 for j in range(3) if j != k)
    return ("<inertial><pose>%.9g %.9g %.9g 0 0 0</pose><mass>%.9g</mass><inertia><ixx>%.9g</ixx><iyy>%.9g</iyy>"
            "<izz>%.9g</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>" % (*centre, mass_kg, *moments))


def shape_of(number: int, part: Part) -> str:
    """Returns <collision> and <visual> of a part."""
    shape, sizes, at, color = part
    words = [" ".join(map(repr, map(float, sizes)))] if shape == "box" else [repr(float(size)) for size in sizes]
    inside = "".join("<%s>%s</%s>" % (tag, word, tag) for tag, word in zip(TAGS[shape], words))
    place = "<pose>%g %g %g 0 0 0</pose><geometry><%s>%s</%s></geometry>" % (*at, shape, inside, shape)
    rgba = "%g %g %g 1" % color
    return ("      <collision name='part_%d'>%s</collision>\n      <visual name='part_%d'>%s<material><ambient>%s"
            "</ambient><diffuse>%s</diffuse></material></visual>\n" % (number, place, number, place, rgba, rgba)
            ).replace("\\\\n", "\\n")


def document(name: str) -> str:
    """Returns the text of a model's model.sdf."""
    (mass_kg, parts), place = MODELS[name], ""
    if name.startswith(IN_THE_MIDDLE):
        place = "<pose>%g %g %g 0 0 0</pose>" % parts[0][2]
        parts = [(*parts[0][:2], (0, 0, 0), parts[0][3])]
    return ("<?xml version='1.0'?>\n<sdf version='1.6'>\n  <model name='%s'>\n    <static>%s</static>\n"
            "    <link name='link'>\n      %s%s\n%s    </link>\n  </model>\n</sdf>\n" % (
                name, "false" if mass_kg else "true", place, inertial_of(mass_kg, parts) if mass_kg else "",
                "".join(shape_of(number, part) for number, part in enumerate(parts))))


def board_mesh() -> str:
    """Returns the COLLADA text of a board of 8 x 8 squares, 2 m wide, in the plane z = 0, seen from above.

    The square in the corner of least x and largest y is white. No light and no shadow changes its two colours."""
    points, corners = [], {"white": [], "black": []}
    for row in range(8):
        for column in range(8):
            x, y, first = column / 4 - 1, row / 4 - 1, len(points)
            points += [(x, y, 0), (x + 0.25, y, 0), (x + 0.25, y + 0.25, 0), (x, y + 0.25, 0)]
            corners["white" if (row + column) % 2 else "black"] += [first + k for k in (0, 1, 2, 0, 2, 3)]
    effects = "".join(
        "<effect id='%s_effect'><profile_COMMON><technique sid='common'><lambert><emission><color>%s</color></emission>"
        "<diffuse><color>0 0 0 1</color></diffuse></lambert></technique></profile_COMMON></effect>" % (name, color)
        for name, color in (("white", "1 1 1 1"), ("black", "0 0 0 1")))
    materials = "".join("<material id='%s'><instance_effect url='#%s_effect'/></material>" % (name, name)
                        for name in corners)
    triangles = "".join(
        "<triangles material='%s' count='%d'><input semantic='VERTEX' source='#vertices' offset='0'/><p>%s</p>"
        "</triangles>" % (name, len(indices) // 3, " ".join(map(str, indices))) for name, indices in corners.items())
    bound = "".join("<instance_material symbol='%s' target='#%s'/>" % (name, name) for name in corners)
    return ("<?xml version='1.0'?>\n<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>\n"
            "<asset><unit name='meter' meter='1'/><up_axis>Z_UP</up_axis></asset>\n"
            "<library_effects>%s</library_effects>\n<library_materials>%s</library_materials>\n"
            "<library_geometries><geometry id='board'><mesh><source id='points'>\n<float_array id='numbers' count='%d'>"
            "%s</float_array>\n<technique_common><accessor source='#numbers' count='%d' stride='3'>"
            "<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
            "</technique_common></source><vertices id='vertices'><input semantic='POSITION' source='#points'/>"
            "</vertices>\n%s</mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id='scene'>"
            "<node><instance_geometry url='#board'><bind_material><technique_common>%s</technique_common>"
            "</bind_material></instance_geometry></node></visual_scene></library_visual_scenes>\n"
            "<scene><instance_visual_scene url='#scene'/></scene>\n</COLLADA>\n" % (
                effects, materials, 3 * len(points), " ".join("%g %g %g" % point for point in points), len(points),
                triangles, bound))


def texts() -> typing.Dict[str, str]:
    """Returns the text of model.sdf of each model by its name."""
    board = ("<?xml version='1.0'?>\n<sdf version='1.6'>\n  <model name='%s'>\n    <static>true</static>\n"
             "    <link name='link'>\n      <visual name='visual'><geometry><mesh><uri>model://%s/%s</uri></mesh>"
             "</geometry></visual>\n    </link>\n  </model>\n</sdf>\n" % (BOARD, BOARD, BOARD_MESH))
    return {**{name: document(name) for name in MODELS}, BOARD: board}


def write(folder: pathlib.Path) -> None:
    """Writes all models into a folder. Args: folder: pathlib.Path, is made where it is not there."""
    mesh = folder / BOARD / BOARD_MESH
    mesh.parent.mkdir(parents=True, exist_ok=True)
    mesh.write_text(board_mesh(), encoding="utf-8")
    for name, text in texts().items():
        place = folder / name
        place.mkdir(parents=True, exist_ok=True)
        (place / "model.sdf").write_text(text, encoding="utf-8")
        (place / "model.config").write_text(
            "<?xml version='1.0'?>\n<model>\n  <name>%s</name>\n  <version>1.0</version>\n"
            "  <sdf version='1.6'>model.sdf</sdf>\n  <description>Plain shapes in the size of the model of that name "
            "in Gazebo's database.</description>\n</model>\n" % name, encoding="utf-8")


if __name__ == "__main__":
    write(pathlib.Path(sys.argv[1]))
