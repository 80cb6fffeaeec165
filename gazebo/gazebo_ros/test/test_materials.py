"""Scripts of materials that a package brings: their colours and pictures, and what is ignored of them."""
import numpy
import pytest

from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.materials import Material, read_script
from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.world import World

SCRIPT = """
/* a comment { with a brace */
import * from "somewhere"
material Own/Plain
{
  technique { pass {
    ambient 0.1 0.2 0.3 1 // words
    diffuse 0.9 0.1 0.1
    specular 0.2 0.3 0.4 1 12.5
    emissive 0 0 0.25
  }
  pass { diffuse 0 0 0 } }
}
material Own/Board : Own/Plain
{
  receive_shadows on
  technique
  {
    pass
    {
      lighting off
      texture_unit
      {
        texture "board.png"
        filtering trilinear
        scroll_anim 1 0
      }
    }
  }
}
vertex_program some glsl
{
  source x.glsl
}
"""
EYE = """<robot name='eye'><link name='world'/><link name='base'/><joint name='j' type='fixed'><parent link='world'/>
  <child link='base'/></joint>
  <gazebo reference='base'><sensor type='camera' name='eye'><update_rate>20</update_rate><camera>
  <horizontal_fov>0.6</horizontal_fov><image><width>40</width><height>40</height></image>
  <clip><near>0.02</near><far>20</far></clip></camera>
  <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo></robot>"""
BOARD = """<sdf version='1.6'><model name='board'><static>true</static><link name='l'><visual name='v'><geometry><box>
  <size>0.1 1 1</size></box></geometry><material><script><uri>model://own/materials/scripts</uri>
  <uri>model://own/materials/textures</uri><name>%s</name></script></material></visual></link></model></sdf>"""


class Folders(NoFolders):
    def __init__(self, folder):
        self._folder = folder

    def __call__(self, name):
        return str(self._folder) if name == "own" else None


@pytest.fixture
def own(tmp_path):
    """A model's folder with a script and a picture whose upper half is green and whose lower half is blue."""
    (tmp_path / "materials" / "scripts").mkdir(parents=True)
    (tmp_path / "materials" / "textures").mkdir()
    (tmp_path / "materials" / "scripts" / "own.material").write_text(SCRIPT)
    halves = b"".join(bytes((0, 255, 0) if row < 8 else (0, 0, 255)) * 16 for row in range(16))
    from PIL import Image
    Image.frombytes("RGB", (16, 16), halves).save(tmp_path / "materials" / "textures" / "board.png")
    return Folders(tmp_path)


def shown(folders, name):
    """Image of the board from the front, and the board."""
    world = World(folders=folders)
    world.spawn("eye", EYE, pose=matrix_of((4, 0, 1), (0, 0, 1, 0), "test"))  # on the side of the sun
    board = world.spawn_sdf("board", BOARD % name, pose=matrix_of((2, 0, 1), (0, 0, 0, 1), "test"))
    world.core.step_to_image("eye::eye")
    return numpy.asarray(world.core.render("eye::eye"), float), board


def test_colours_and_the_picture_of_the_first_pass_are_read():
    plain, board = read_script(SCRIPT)["Own/Plain"], read_script(SCRIPT)["Own/Board"]
    assert (plain.ambient, plain.diffuse, plain.emissive) == ([0.1, 0.2, 0.3, 1.0], [0.9, 0.1, 0.1], [0.0, 0.0, 0.25])
    assert plain.specular == [0.2, 0.3, 0.4, 1.0] and plain.ignored == ()
    assert board.diffuse == plain.diffuse, "of its parent"
    assert board.texture == "board.png" and (board.lit, board.ignored) == (False, ("scroll_anim",))


def test_of_its_texture_units_the_first_counts_and_a_child_has_its_own_picture():
    unit = "texture_unit { texture %s\n scale %s\n rotate 30\n scroll 0.1 -0.2 \n tex_address_mode clamp }"
    script = ("material A\n{ technique { pass { %s %s\n lighting off } } }\n"
              "material B : A\n{ technique { pass { %s } } }") % (
        unit % ("a.png", "0.5 4"), unit % ("never.png", "9 9"), "texture_unit { texture b.png }")
    first, child = read_script(script)["A"], read_script(script)["B"]
    assert (first.texture, first.scale, first.scroll, first.rotate) == ("a.png", (0.5, 4.0), (0.1, -0.2), 30.0)
    assert (first.address, first.lit, first.ignored) == ("clamp", False, ())
    assert (child.texture, child.scale) == ("b.png", (0.5, 4.0)), "and what it does not state of its parent"
    for wrong in ("scale 0 1", "scale 2", "scale x y", "scroll 1", "rotate", "rotate inf"):
        assert read_script("material A\n{ pass { texture_unit { %s\n } } }" % wrong)["A"].texture_transform() is None


@pytest.mark.parametrize("given, surface, picture", [
    (Material(scale=(0.5, 0.25)), (0.75, 0.75), (1.0, 1.5)),  # 2 and 4 pictures, the middle of one in the middle
    (Material(scroll=(0.25, 0.5)), (0.0, 0.0), (0.25, 0.5)),
    (Material(rotate=90.0), (1.0, 0.5), (0.5, 1.0)),
    (Material(scale=(2.0, 2.0), scroll=(0.25, 0.0), rotate=180.0), (0.5, 0.5), (0.25, 0.5))])
def test_a_picture_lies_on_a_surface_as_its_texture_unit_says(given, surface, picture):
    A = given.texture_transform()
    assert A[:, :2] @ surface + A[:, 2] == pytest.approx(picture, abs=1e-12)
    assert Material().texture_transform() is None


@pytest.mark.parametrize("said, bands", [
    ("scale 0.5 0.5", {(8, 20): "blue", (16, 20): "green", (24, 20): "blue", (32, 20): "green"}),
    ("scale 0.04 3", {(12, 20): "green", (28, 20): "blue", (8, 10): "green", (32, 30): "blue"}),
    ("scroll 0 0.5", {(12, 20): "blue", (28, 20): "green"}),
    ("rotate 90", {(20, 12): "green", (20, 28): "blue", (32, 12): "green", (8, 28): "blue"})])
def test_a_board_repeats_moves_and_turns_its_picture(own, said, bands):
    script = own._folder / "materials" / "scripts" / "own.material"
    script.write_text(SCRIPT.replace("scroll_anim 1 0", said))
    image, board = shown(own, "Own/Board")
    for (row, column), color in bands.items():
        assert image[row, column].tolist() == ([0.0, 255.0, 0.0] if color == "green" else [0.0, 0.0, 255.0]), color
    assert board.warnings == []
    script.write_text(SCRIPT.replace("scroll_anim 1 0", said + "\ntex_address_mode clamp"))
    assert ["clamp" in line for line in shown(own, "Own/Board")[1].warnings] == [True]


@pytest.mark.parametrize("text", ["", "}}}", "material", "material X {",
                                  "material X\n{ diffuse red green blue\n}", "{" * 99])
def test_a_script_that_is_none_is_tolerated(text):
    assert all(each.diffuse is None for each in read_script(text).values())


def test_a_board_has_the_colour_that_its_script_says(own):
    image, board = shown(own, "Own/Plain")
    red, green, blue = image[20, 20]
    assert blue > red > 2 * green, "emissive blue, less red by the slant of the light"
    assert board.warnings == []


def test_a_board_shows_the_picture_that_its_script_names_and_the_rest_is_named(own):
    image, board = shown(own, "Own/Board")
    upper, lower = image[12, 20], image[28, 20]
    assert upper[1] > 2 * upper[2] and lower[2] > 3 * lower[1], (upper, lower)
    assert board.warnings == ["material 'Own/Board': scroll_anim: ignored"]


def test_without_lighting_a_picture_has_its_own_colours_in_light_and_shadow(own):
    image, _ = shown(own, "Own/Board")
    assert image[12, 20].tolist() == [0.0, 255.0, 0.0] and image[28, 20].tolist() == [0.0, 0.0, 255.0]
    script = own._folder / "materials" / "scripts" / "own.material"
    script.write_text(SCRIPT.replace("lighting off", "lighting on"))
    assert shown(own, "Own/Board")[0][12, 20, 1] < 250.0
    script.write_text(SCRIPT)
    world = World(folders=own)
    world.spawn("eye", EYE, pose=matrix_of((4, 0, 1), (0, 0, 1, 0), "test"))
    for name in world.lights:
        world.delete_light(name)
    world.spawn_sdf("board", BOARD % "Own/Board", pose=matrix_of((2, 0, 1), (0, 0, 0, 1), "test"))
    before = world.core.render("eye::eye").copy()
    world.spawn_light("lamp", "<light name='lamp' type='point'><pose>0 0 9 0 0 0</pose></light>")
    assert (world.core.render("eye::eye")[12:28, 12:28] == before[12:28, 12:28]).all(), "whatever lights there are"
    assert before[12, 20].tolist() == [0, 255, 0]


@pytest.mark.parametrize("given, glows, told", [
    ("<emissive>1 1 1 0</emissive>", True, []), ("<lighting>1</lighting><emissive>1 1 1 1</emissive>", True, []),
    ("<emissive>0 0 0 1</emissive>", False, []),
    ("<emissive>1 0.5 1 1</emissive>", False,
     ["material 'Own/Board': <emissive> beside a picture, less than 1 1 1: ignored"])])
def test_a_picture_that_gives_light_has_its_own_colours_and_is_not_washed_out(own, given, glows, told):
    script = own._folder / "materials" / "scripts" / "own.material"
    script.write_text(SCRIPT.replace("lighting off", "lighting on").replace("scroll_anim 1 0", ""))
    world = World(folders=own)
    world.spawn("eye", EYE, pose=matrix_of((4, 0, 1), (0, 0, 1, 0), "test"))
    board = world.spawn_sdf("board", BOARD.replace("</script>", "</script>" + given) % "Own/Board",
                            pose=matrix_of((2, 0, 1), (0, 0, 0, 1), "test"))
    upper, lower = (world.core.render("eye::eye")[row, 20].astype(int) for row in (12, 28))
    assert max(upper[0], lower[0], upper[2], lower[1]) < 10, "green above, blue below: the picture, and a highlight"
    assert (upper[1] == lower[2] == 255) == glows and board.warnings == told


def test_a_picture_that_is_not_there_is_named(own):
    (own._folder / "materials" / "textures" / "board.png").unlink()
    assert "material 'Own/Board': picture board.png is not found: ignored" in shown(own, "Own/Board")[1].warnings


def test_a_material_that_is_nowhere_is_named(own):
    warnings = "\n".join(shown(own, "Own/Other")[1].warnings)
    assert "material 'Own/Other' is not a plain colour of Gazebo's: ignored" in warnings
