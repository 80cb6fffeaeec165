"""Stand-ins for models of Gazebo's database."""
import pathlib
import sys

import numpy
import pytest

from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.world import read_world
from gazebo_ros.world.world import World

MODELS = pathlib.Path(__file__).resolve().parents[1] / "models"
sys.path.insert(0, str(MODELS))
import stand_ins  # noqa: E402


class Here(NoFolders):
    """Finds models where they were written, and those of the package."""

    def __init__(self, folder):
        self._folder = folder

    def __call__(self, name):
        places = [place / name for place in (self._folder, MODELS) if (place / name).is_dir()]
        return str(places[0]) if places else None


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    stand_ins.write(folder)
    return Here(folder)


def filled(folders, inside):
    """A world of these elements, with the ground."""
    file = read_world("<sdf version='1.6'><world name='w'><include><uri>model://ground_plane</uri></include>%s"
                      "</world></sdf>" % inside, False, folders)
    assert not file.warnings
    world = World(file.settings, folders)
    for model, X_WM in file.models:
        world.place_sdf(model.name, model, X_WM)
    return world


def test_what_stands_on_a_table_stays_there(folders):
    world = filled(folders, """<include><uri>model://table</uri></include><model name="cup"><pose>0 0 1.1 0 0 0</pose>
<link name="l"><inertial><mass>.1</mass></inertial><collision name="c"><geometry><cylinder><radius>.03</radius>
<length>.1</length></cylinder></geometry></collision></link></model>""")
    world.step(1500)
    assert world.models["cup"].pose()[:3, 3] == pytest.approx((0.0, 0.0, 1.0 + 0.015 + 0.05), abs=2e-3)


@pytest.mark.parametrize("name", sorted(stand_ins.MODELS))
def test_each_model_loads_and_one_with_mass_comes_to_rest_on_the_ground(folders, name):
    mass_kg, parts = stand_ins.MODELS[name]
    lowest = min(part[2][2] - (part[1][0] if part[0] == "sphere" else part[1][-1] / 2) for part in parts)
    world = filled(folders, "<include><uri>model://%s</uri><name>m</name><pose>0 0 %r 0 0 0</pose></include>" %
                   (name, -lowest))
    model = world.models["m"]
    assert model.warnings == [] and model.description.fixed == (mass_kg == 0)
    if mass_kg == 0:
        return
    assert model.properties_of("link").mass_kg == pytest.approx(mass_kg)
    world.step(300)
    assert model.pose()[2, 3] == pytest.approx(-lowest, abs=0.01) and abs(model.twist()).max() < 0.01


def test_the_board_has_eight_squares_an_edge_two_metres_wide_also_where_a_world_names_its_mesh(folders):
    """The camera hangs 2 m above the middle, image x along the board's x and image y against its y."""
    camera = """<model name="camera"><static>1</static><pose>0 0 2 0 1.5707963267948966 1.5707963267948966</pose>
<link name="l"><sensor type="camera" name="eye"><update_rate>1</update_rate><camera>
<horizontal_fov>1.0471975511965976</horizontal_fov><image><width>240</width><height>240</height></image></camera>
<plugin name="p" filename="libgazebo_ros_camera.so"><cameraName>eye</cameraName></plugin></sensor></link></model>"""
    mesh = """<model name="saved"><static>1</static><link name="a::b"><visual name="v"><geometry><mesh>
<uri>model://checkerboard_plane/meshes/checkerboard_plane.dae</uri></mesh></geometry></visual></link></model>"""
    for board in ("<include><uri>model://checkerboard_plane</uri><pose>0 0 0.001 0 0 0</pose></include>",
                  mesh.replace("<static>", "<pose>0 0 0.001 0 0 0</pose><static>")):
        world = filled(folders, board + camera)
        image = world.core.render("camera::eye")[..., 0].astype(int)
        edge_px = 120 / numpy.tan(numpy.pi / 6) / 2 / 4  # of one square
        middles = numpy.rint(119.5 + edge_px * (numpy.arange(-4, 4) + 0.5)).astype(int)
        seen = image[numpy.ix_(middles, middles)]
        white = numpy.add.outer(numpy.arange(8), numpy.arange(8)) % 2 == 0
        assert (seen[white] > 250).all() and (seen[~white] < 5).all()
        assert 100 < image[119, 5] < 250, "the ground beside it"
