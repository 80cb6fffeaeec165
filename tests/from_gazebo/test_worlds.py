"""A .world file and models of SDF over ROS, as launch files and spawn_model hand them over."""
import subprocess

import pytest
from ros_graph import Graph

WORLD = """<sdf version="1.6"><world name="default">
  <include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>
  <include><uri>model://of_a_database</uri></include>
  <physics type="ode"><max_step_size>0.002</max_step_size><real_time_update_rate>500</real_time_update_rate></physics>
  <gravity>0 0 -5</gravity><actor name="walker"/>
  <include><uri>model://shelf</uri><name>left_shelf</name><pose>0 1 0 0 0 0</pose></include></world></sdf>"""
SHELF = """<sdf version="1.6"><model name="shelf"><static>true</static><link name="board">
  <collision name="c"><pose>0 0 0.5 0 0 0</pose><geometry><box><size>1 0.5 0.04</size></box></geometry></collision>
  </link></model></sdf>"""
BALL = """<sdf version="1.6"><model name="ball"><link name="ball"><inertial><mass>0.5</mass>
  <inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial>
  <collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision></link></model></sdf>"""
GIVES_WAY_M = 1e-3  #: a contact, by the weight over its stiffness


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    """A world of a file whose models are in GAZEBO_MODEL_PATH."""
    folder = tmp_path_factory.mktemp("ros")
    shelf = folder / "models" / "shelf"
    shelf.mkdir(parents=True)
    (shelf / "model.config").write_text("<model><name>shelf</name><sdf version='1.6'>model.sdf</sdf></model>")
    (shelf / "model.sdf").write_text(SHELF)
    (folder / "room.world").write_text(WORLD)
    (folder / "ball.sdf").write_text(BALL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GAZEBO_MODEL_PATH", str(folder / "models"))
        with Graph(folder) as graph:
            graph.start("roslaunch", "-p", str(graph.port), "gazebo_ros", "empty_world.launch", "gui:=false",
                        "world_name:=%s" % (folder / "room.world"))
            graph.until(lambda: "/gazebo/model_states" in graph.topics(), "the world is there")
            graph.folder_of_files = folder
            yield graph


def answer(graph, service, request=""):
    return graph.answer("/gazebo/" + service, request)


def test_the_world_is_that_of_the_file(room):
    assert answer(room, "get_world_properties")["model_names"] == ["ground_plane", "left_shelf"]
    physics = answer(room, "get_physics_properties")
    assert physics["time_step"] == 0.002 and physics["max_update_rate"] == 500 and physics["gravity"]["z"] == -5.0
    assert answer(room, "get_light_properties", "{light_name: sun}")["success"]
    room.until(lambda: "model://of_a_database" in room.log() and "<actor name='walker'>" in room.log(), "the warnings")


def test_a_model_of_sdf_is_spawned_and_comes_to_rest_on_one_of_the_world(room):
    room.output("rosrun", "gazebo_ros", "spawn_model", "-sdf", "-file", str(room.folder_of_files / "ball.sdf"),
                "-model", "ball", "-y", "1", "-z", "0.8")
    room.until(lambda: abs(answer(room, "get_model_state", "{model_name: ball}")["pose"]["position"]["z"] - 0.57)
               < GIVES_WAY_M, "the ball lies on the shelf")


@pytest.mark.parametrize("service, request_text, text", [
    ("spawn_sdf_model", "{model_name: left_shelf, model_xml: '%s'}" % BALL.replace("\n", " "), "already exists"),
    ("spawn_sdf_model", "{model_name: ground_plane, model_xml: '%s'}" % BALL.replace("\n", " "), "already exists"),
    ("spawn_sdf_model", "{model_name: other, model_xml: <sdf>}", "entity format is invalid"),
    ("spawn_sdf_model", "{model_name: other, model_xml: \"<sdf version='1.6'><include><uri>model://none</uri></include>"
     "</sdf>\"}", "model://none"),
    ("delete_model", "{model_name: nobody}", "DeleteModel: model does not exist")])
def test_what_cannot_be_is_refused_and_the_world_goes_on(room, service, request_text, text):
    told = answer(room, service, request_text)
    assert not told["success"] and text in told["status_message"], told
    assert answer(room, "get_world_properties")["success"]


#: A model whose service has the name of another's, and whose cameras' topics begin with /.
SEEING = """<sdf version="1.6"><model name="m"><static>1</static><link name="arm::eye"><pose frame="">0 0 1 0 0 0</pose>
  <sensor name="s" type="camera"><camera><horizontal_fov>wide</horizontal_fov><image><width>16</width>
  <height>12</height></image></camera><plugin name="c" filename="libgazebo_ros_camera.so"><cameraName>ey e</cameraName>
  <imageTopicName>/seen/image</imageTopicName></plugin></sensor>
  </link>
  <plugin name="i" filename="libgazebo_ros_imu.so"><bodyName>arm::eye</bodyName><serviceName>/calibrated</serviceName>
  </plugin></model></sdf>"""


def test_a_world_that_does_not_exist_ends_the_server_and_a_faulty_one_does_not(tmp_path):
    with Graph(tmp_path) as graph:
        graph.start("roscore", "-p", str(graph.port))
        graph.until(lambda: "/rosout" in graph.topics(), "the master is there")
        with pytest.raises(subprocess.CalledProcessError) as caught:
            graph.output("rosrun", "gazebo_ros", "gzserver", "worlds/nowhere.world")
        assert caught.value.returncode == 255 and "Could not open file[worlds/nowhere.world]" in graph.log()
        (tmp_path / "broken.world").write_text("<sdf version='1.6'><world name='w'><model")
        (tmp_path / "seeing.sdf").write_text(SEEING)
        graph.start("rosrun", "gazebo_ros", "gzserver", str(tmp_path / "broken.world"))
        graph.until(lambda: "/gazebo/model_states" in graph.topics(), "the world is there")
        assert "broken.world" in graph.log()
        for name in ("b", "a"):
            graph.output("rosrun", "gazebo_ros", "spawn_model", "-sdf", "-file", str(tmp_path / "seeing.sdf"),
                         "-model", name)
        assert graph.message("/gazebo/link_states")["name"] == ["ground_plane::link", "b::arm::eye", "a::arm::eye"]
        assert graph.message("/gazebo/model_states")["name"] == ["ground_plane", "b", "a"]
        assert graph.message("/seen/image")["width"] == 16 and "/ey_e/camera_info" in graph.topics()
        assert all(text in graph.log() for text in ("/calibrated", "'wide'", "horizontal_fov"))
