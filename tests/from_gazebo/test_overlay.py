"""A package of the kind that was written for Gazebo, started by its own launch files over the packages in gazebo/."""
import pathlib
import signal
import sys
import time

import pytest
import yaml
from ros_graph import Graph

HERE = pathlib.Path(__file__).resolve().parent
MOVE = str(HERE / "demo_arm" / "scripts" / "move.py")


def launched(folder, name, *arguments):
    graph = Graph(folder)
    graph.start("roslaunch", "-p", str(graph.port), "demo_arm", name, *arguments)
    return graph


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    with launched(tmp_path_factory.mktemp("ros"), "world.launch", "gui:=true") as graph:
        graph.until(lambda: "Started controllers" in graph.log(), "the controllers run")
        yield graph


def moved(graph, *words):
    return yaml.safe_load(graph.output(sys.executable, MOVE, *words))


def joint(graph, name):
    message = graph.message("/joint_states")
    return message["position"][message["name"].index(name)]


def test_only_the_controllers_that_were_asked_for_run(arm):
    listed = arm.answer("/controller_manager/list_controllers")["controller"]
    assert {each["name"]: each["state"] for each in listed} == {
        "joint_state_controller": "running", "arm_controller": "running", "hand_controller": "running"}
    claimed = {each["name"]: each["claimed_resources"] for each in listed}["arm_controller"]
    assert claimed == [{"hardware_interface": "hardware_interface::EffortJointInterface",
                        "resources": ["shoulder", "elbow"]}]


def test_what_gazebo_tolerates_is_named_in_a_warning(arm):
    arm.until(lambda: "<gazebo reference='link_of_another_variant'>" in arm.log(), "the warning")


def test_joint_states_and_images_come_under_gazebos_names(arm):
    expected = {"/clock": "rosgraph_msgs/Clock", "/joint_states": "sensor_msgs/JointState",
                "/eye/image_raw": "sensor_msgs/Image", "/eye/camera_info": "sensor_msgs/CameraInfo",
                "/gazebo/model_states": "gazebo_msgs/ModelStates",
                "/arm_controller/state": "control_msgs/JointTrajectoryControllerState",
                "/arm_controller/follow_joint_trajectory/status": "actionlib_msgs/GoalStatusArray"}
    arm.until(lambda: expected.items() <= arm.topics().items(), "the topics")
    image = arm.message("/eye/image_raw")
    assert (image["width"], image["height"], image["encoding"]) == (64, 48, "rgb8")
    names = arm.message("/joint_states")["name"]
    assert names == ["elbow", "finger", "shoulder"]


def test_a_trajectory_is_followed_to_its_end(arm):
    told = moved(arm, "0.5", "-0.4", "1.0")
    assert told["state"] == "SUCCEEDED" and told["error_code"] == 0 and told["feedback"] > 5, told
    assert abs(joint(arm, "shoulder") - 0.5) < 0.05 and abs(joint(arm, "elbow") + 0.4) < 0.05


def test_a_goal_can_be_cancelled(arm):
    assert moved(arm, "-0.5", "0.4", "5.0", "cancel")["state"] == "PREEMPTED"


@pytest.mark.parametrize("how, state, code, text", [
    ("tight", "ABORTED", -4, "elbow path error"),
    ("wrong_joints", "REJECTED", -2, "Joints on incoming goal don't match the controller joints."),
    ("backwards", "REJECTED", -1, "not strictly increasing in time"),
    ("not_a_number", "REJECTED", -1, "not finite")])
def test_a_goal_that_cannot_be_reached_is_answered_as_ros_control_answers(arm, how, state, code, text):
    told = moved(arm, "0.3", "0.3", "0.5", how)
    assert (told["state"], told["error_code"]) == (state, code) and text in told["error_string"], told


def test_a_gripper_closes(arm):
    told = moved(arm, "hand", "0.03")
    assert told["state"] == "SUCCEEDED" and told["reached_goal"], told
    assert abs(joint(arm, "finger") - 0.03) < 0.011


def test_controllers_are_switched_by_the_rules_of_the_controller_manager(arm):
    def load(name):
        return arm.answer("/controller_manager/load_controller", "{name: %s}" % name)["ok"]

    def switch(start, stop, strictness=2):
        request = "{start_controllers: %s, stop_controllers: %s, strictness: %d}" % (start, stop, strictness)
        return arm.answer("/controller_manager/switch_controller", request)["ok"]
    assert load("shoulder_position") and not load("shoulder_position")
    assert not load("of_another_robot") and not load("nobody")
    assert not switch("[shoulder_position]", "[]"), "the arm has the shoulder"
    assert not switch("[nobody]", "[]")
    assert switch("[shoulder_position]", "[arm_controller]")
    said = arm.output("rosrun", "controller_manager", "controller_manager", "list")
    assert "'shoulder_position' - 'effort_controllers/JointPositionController' ( running )" in said
    assert "'arm_controller' - 'effort_controllers/JointTrajectoryController' ( stopped )" in said
    assert moved(arm, "0.1", "0.1", "0.5")["state"] == "REJECTED"
    assert switch("[arm_controller]", "[shoulder_position, nobody]", 1)
    assert arm.answer("/controller_manager/unload_controller", "{name: shoulder_position}")["ok"]
    assert not arm.answer("/controller_manager/unload_controller", "{name: arm_controller}")["ok"], "it is running"
    assert "due to resource conflict: joint 'shoulder'" in arm.log()


def test_the_world_answers_as_gazebo_does(arm):
    state = arm.answer("/gazebo/get_model_state", "{model_name: demo_arm}")
    assert state["success"] and abs(state["pose"]["position"]["z"] - 0.1) < 1e-9
    assert arm.answer("/gazebo/get_world_properties")["model_names"] == ["ground_plane", "demo_arm"]
    assert arm.answer("/gazebo/get_link_state", "{link_name: 'demo_arm::elbow_link'}")["success"]
    for service, request, text in (
            ("get_model_state", "{model_name: nobody}", "GetModelState: model does not exist"),
            ("delete_model", "{model_name: nobody}", "DeleteModel: model does not exist"),
            ("set_model_state", "{model_state: {model_name: nobody}}", "SetModelState: model does not exist"),
            ("spawn_urdf_model", "{model_name: demo_arm, model_xml: <robot/>}", "entity already exists"),
            ("spawn_urdf_model", "{model_name: other, model_xml: <robo}", "entity format is invalid"),
            ("get_light_properties", "{light_name: moon}", "Requested light moon not found!"),
            ("set_light_properties", "{light_name: sun, diffuse: {r: -1.0}}", "color_rgb"),
            ("spawn_sdf_model", "{model_name: other, model_xml: <sdf/>}", "entity format is invalid"),
            ("apply_body_wrench", "{body_name: x}", "ApplyBodyWrench: body does not exist"),
            ("apply_joint_effort", "{joint_name: x}", "ApplyJointEffort: joint not found"),
            ("set_link_properties", "{link_name: x}", "link not found"),
            ("set_link_state", "{link_state: {link_name: elbow_link}}", "which joints hold")):
        told = arm.answer("/gazebo/" + service, request)
        assert not told["success"] and text in told["status_message"], told


def test_lights_are_asked_for_changed_spawned_and_deleted(arm):
    sun = arm.answer("/gazebo/get_light_properties", "{light_name: sun}")
    assert sun["success"] and abs(sun["diffuse"]["r"] - 0.8) < 1e-6
    assert arm.answer("/gazebo/set_light_properties", "{light_name: sun, diffuse: {r: 0.5, g: 0.5, b: 0.5, a: 1.0}, "
                      "cast_shadows: true, direction: {z: -1.0}}")["success"]
    assert abs(arm.answer("/gazebo/get_light_properties", "{light_name: sun}")["diffuse"]["r"] - 0.5) < 1e-6
    lamp = "<light name='any' type='point'><diffuse>0.2 0.2 0.2 1</diffuse></light>"
    assert arm.answer("/gazebo/spawn_sdf_model", '{model_name: lamp, model_xml: "%s"}' % lamp)["success"]
    assert abs(arm.answer("/gazebo/get_light_properties", "{light_name: lamp}")["attenuation_linear"] - 1.0) < 1e-9
    assert arm.answer("/gazebo/delete_light", "{light_name: lamp}")["success"]
    assert not arm.answer("/gazebo/delete_light", "{light_name: lamp}")["success"]


def test_time_stands_still_while_it_is_paused_and_begins_again_after_a_reset(arm):
    def now():
        return arm.answer("/gazebo/get_world_properties")["sim_time"]
    arm.answer("/gazebo/pause_physics")
    before = now()
    time.sleep(0.2)
    assert now() == before
    arm.answer("/gazebo/unpause_physics")
    before = now()
    arm.until(lambda: now() > before, "time goes on")
    arm.answer("/gazebo/reset_simulation")
    assert now() < before
    told = moved(arm, "0.2", "0.1", "1.0")
    assert told["state"] == "SUCCEEDED", "the action goes on after time went back: %s" % told


def test_two_robots_live_in_their_namespaces(tmp_path_factory):
    with launched(tmp_path_factory.mktemp("ros"), "two.launch") as graph:
        graph.until(lambda: graph.log().count("Started controllers") == 2, "the controllers of both run")
        assert sorted(graph.answer("/gazebo/get_world_properties")["model_names"][1:]) == ["left", "right"]
        for name, controller in (("left", "arm_controller"), ("right", "joint_group_effort")):
            listed = graph.answer("/%s/controller_manager/list_controllers" % name)["controller"]
            assert [each["name"] for each in listed] == ["joint_state_controller", controller]
        assert graph.answer("/gazebo/delete_model", "{model_name: left}")["success"]
        services = graph.output("rosservice", "list").split()
        assert not [each for each in services if each.startswith("/left/controller_manager")]
        publishers = graph.output("rostopic", "list", "-p").split()
        assert "/left/joint_states" not in publishers and "/right/joint_states" in publishers
        assert graph.answer("/right/controller_manager/list_controllers")["controller"]


def test_what_spawned_a_model_with_a_bond_deletes_it_when_it_ends(tmp_path_factory):
    with Graph(tmp_path_factory.mktemp("ros")) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "gazebo_ros", "empty_world.launch", "gui:=false",
                    "paused:=true")
        graph.until(lambda: "/gazebo/model_states" in graph.topics(), "the world")
        ball = ("<robot name='ball'><link name='ball'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' "
                "ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><sphere radius='0.1'/></geometry></collision>"
                "</link></robot>")
        file = pathlib.Path(tmp_path_factory.mktemp("ball")) / "ball.urdf"
        file.write_text(ball)
        spawner = graph.start("rosrun", "gazebo_ros", "spawn_model", "-urdf", "-file", str(file), "-model", "ball",
                              "-z", "2.0", "-unpause", "-b")

        def height():
            state = graph.answer("/gazebo/get_model_state", "{model_name: ball}")
            return state["pose"]["position"]["z"] if state["success"] else None
        graph.until(lambda: height() is not None, "the ball is there")
        graph.until(lambda: abs(height() - 0.1) < 0.01, "it has fallen on the ground plane")
        spawner.send_signal(signal.SIGINT)
        graph.until(lambda: height() is None, "it is deleted")
