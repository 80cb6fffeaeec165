"""A cart whose plugins drive its wheels and publish its sensors, and what pushes it from outside."""
import numpy
import pytest
import yaml
from ros_graph import Graph


@pytest.fixture(scope="module")
def cart(tmp_path_factory):
    with Graph(tmp_path_factory.mktemp("ros")) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "demo_cart", "world.launch")
        graph.until(lambda: "/odom" in graph.topics(), "the cart is there")
        yield graph


def place(graph):
    return graph.message("/odom")["pose"]["pose"]["position"]


def state(graph):
    return graph.answer("/gazebo/get_model_state", "{model_name: cart}")


def test_a_cart_drives_by_cmd_vel_and_its_odometry_is_where_it_is(cart):
    cart.start("rostopic", "pub", "-1", "/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.2}}")
    cart.until(lambda: place(cart)["x"] > 1.1, "it drives")
    odometry = cart.message("/odom")
    assert (odometry["header"]["frame_id"], odometry["child_frame_id"]) == ("odom", "base_footprint")
    assert abs(odometry["twist"]["twist"]["linear"]["x"] - 0.2) < 0.02
    assert cart.message("/joint_states")["name"] == ["left_wheel_joint", "right_wheel_joint"]
    cart.answer("/gazebo/pause_physics")
    turned = cart.answer("/gazebo/get_joint_properties", "{joint_name: left_wheel_joint}")["position"][0]
    gone = cart.answer("/gazebo/get_model_state", "{model_name: cart}")["pose"]["position"]["x"] - 1.0
    cart.answer("/gazebo/unpause_physics")
    assert gone == pytest.approx(0.05 * turned, rel=0.05), "the wheels roll"
    transform = cart.message("/tf")["transforms"][0]
    assert (transform["header"]["frame_id"], transform["child_frame_id"]) == ("odom", "base_footprint")


def test_a_cart_stops_when_it_is_told_to(cart):
    cart.start("rostopic", "pub", "-1", "/cmd_vel", "geometry_msgs/Twist", "{}")
    cart.until(lambda: abs(cart.message("/odom")["twist"]["twist"]["linear"]["x"]) < 1e-3, "it stands")


def test_sensors_feel_gravity(cart):
    imu = cart.message("/imu")
    assert imu["header"]["frame_id"] == "imu_link" and abs(imu["linear_acceleration"]["z"] - 9.81) < 0.05
    wrench = cart.message("/load_ft")
    assert wrench["header"]["frame_id"] == "load" and abs(wrench["wrench"]["force"]["z"] + 0.5 * 9.81) < 0.05


def test_a_laser_sees_a_wall_where_it_is_put(cart):
    wall = ("<sdf version='1.6'><model name='wall'><static>true</static><link name='l'><collision name='c'><geometry>"
            "<box><size>0.1 20 1</size></box></geometry></collision></link></model></sdf>")

    def ranges():
        return list(map(float, cart.message("/scan")["ranges"]))  # rostopic writes inf, which is no number of YAML

    assert min(ranges()) > 3.5
    told = cart.answer("/gazebo/spawn_sdf_model", yaml.safe_dump(
        {"model_name": "wall", "model_xml": wall, "initial_pose": {"position": {"x": place(cart)["x"] + 2.05}}}))
    assert told["success"], told
    cart.until(lambda: min(ranges()) < 2.1, "it is seen")
    scan = cart.message("/scan")
    assert scan["header"]["frame_id"] == "scanner" and len(scan["ranges"]) == len(scan["intensities"]) == 360
    assert scan["angle_increment"] == pytest.approx(6.28319 / 359) and scan["range_max"] == 3.5
    assert min(ranges()) == pytest.approx(2.0, abs=0.08), "less the noise"
    assert cart.answer("/gazebo/delete_model", "{model_name: wall}")["success"]


POST = """<robot name='post'><link name='world'/><joint name='fix' type='fixed'><parent link='world'/>
  <child link='base'/></joint>%(links)s
  <joint name='turn' type='continuous'><parent link='base'/><child link='tip'/><origin xyz='0 0 0.4'/>
  <axis xyz='0 0 1'/></joint>
  <transmission name='t'><joint name='turn'><hardwareInterface>VelocityJointInterface</hardwareInterface></joint>
  </transmission>
  <gazebo><plugin name='c' filename='libgazebo_ros_control.so'><robotNamespace>/post</robotNamespace></plugin>
  <plugin name='p3d' filename='libgazebo_ros_p3d.so'><bodyName>tip</bodyName><topicName>post/truth</topicName></plugin>
  <plugin name='j' filename='libgazebo_ros_joint_state_publisher.so'><robotNamespace>/plain</robotNamespace>
    <jointName>turn</jointName></plugin>
  <plugin name='v' filename='libgazebo_ros_vacuum_gripper.so'><robotNamespace>/vac</robotNamespace>
    <bodyName>tip</bodyName><topicName>grasping</topicName></plugin></gazebo>
  <gazebo reference='base'><sensor type='contact' name='b'><update_rate>20</update_rate>
    <plugin name='b' filename='libgazebo_ros_bumper.so'><bumperTopicName>hit</bumperTopicName></plugin></sensor>
  %(rays)s
  <sensor type='multicamera' name='pair'><update_rate>10</update_rate>%(lenses)s
    <plugin name='m' filename='libgazebo_ros_multicamera.so'><cameraName>pair</cameraName><frameName>base</frameName>
    <hackBaseline>0.1</hackBaseline></plugin></sensor></gazebo></robot>"""
RAY = """<sensor type='ray' name='%s'><update_rate>20</update_rate><ray><scan><horizontal><samples>2</samples>
  <min_angle>-0.1</min_angle><max_angle>0.1</max_angle></horizontal></scan>
  <range><min>0.06</min><max>4</max></range></ray>
  <plugin name='p' filename='libgazebo_ros_%s.so'><topicName>%s</topicName></plugin></sensor>"""
LINK = """<link name='%s'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>
  </inertial><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>"""
LENS = """<camera name='%s'><horizontal_fov>1.0</horizontal_fov><image><width>8</width><height>6</height></image>
  <clip><near>0.1</near><far>50</far></clip></camera>"""


def height_of(graph, model):
    return graph.answer("/gazebo/get_model_state", "{model_name: %s}" % model)["pose"]["position"]["z"]


def test_plugins_that_hold_and_sense_have_their_topics_and_services(cart):
    """A post with all of them; a can of Gazebo's database on a table is what it holds."""
    tip = LINK.partition("<collision>")[0] % "tip" + "</link>"
    post = POST % {"links": LINK % "base" + tip, "lenses": LENS % "left" + LENS % "right",
                   "rays": RAY % ("r", "range", "near") + RAY % ("l", "block_laser", "cloud")}
    assert height_of(cart, "coke_can") == pytest.approx(1.015 + 0.06, abs=0.01), "it stands on the table"
    told = cart.answer("/gazebo/spawn_urdf_model", yaml.safe_dump(
        {"model_name": "post", "model_xml": post, "initial_pose": {"position": {"x": 0.0, "y": 6.0, "z": 1.5}}}))
    assert told["success"], told
    assert cart.message("/post/truth")["pose"]["pose"]["position"]["z"] == pytest.approx(1.9)
    assert cart.message("/plain/joint_states")["name"] == ["turn"]
    assert cart.message("/near")["range"] == 4.0 and len(cart.message("/cloud")["points"]) == 2
    infos = [cart.message("/pair/%s/camera_info" % side) for side in ("left", "right")]
    assert infos[0]["P"][3] == 0.0 and infos[1]["P"][3] == pytest.approx(-0.1 * infos[1]["P"][0])
    assert cart.message("/hit")["states"] == []
    cart.answer("/gazebo/pause_physics")
    cart.answer("/gazebo/set_model_state", "{model_state: {model_name: coke_can, pose: {position: {y: 6.0, z: 1.87}}}}")
    cart.answer("/vac/on")
    cart.answer("/gazebo/unpause_physics")
    assert cart.message("/vac/grasping")["data"]
    names = "{model_name_1: post, link_name_1: base, model_name_2: coke_can, link_name_2: link}"
    assert cart.answer("/link_attacher_node/attach", names)["ok"]
    cart.answer("/vac/off")
    assert not cart.message("/vac/grasping")["data"] and height_of(cart, "coke_can") > 1.8
    assert cart.answer("/link_attacher_node/detach", names)["ok"]
    cart.until(lambda: height_of(cart, "coke_can") < 1.7, "it falls")
    cart.output("rosparam", "set", "/post/turn_position", "{type: velocity_controllers/JointPositionController, "
                "joint: turn, pid: {p: 20.0}}")
    assert cart.answer("/post/controller_manager/load_controller", "{name: turn_position}")["ok"]
    assert cart.answer("/post/controller_manager/switch_controller",
                       "{start_controllers: [turn_position], stop_controllers: [], strictness: 2}")["ok"]
    cart.start("rostopic", "pub", "-1", "/post/turn_position/command", "std_msgs/Float64", "0.5")
    cart.until(lambda: cart.message("/post/turn_position/state")["process_value"] == pytest.approx(0.5, abs=1e-3),
               "it turns")
    assert cart.answer("/gazebo/delete_model", "{model_name: post}")["success"]


EYE = """<sensor name='%s' type='%s'><update_rate>10</update_rate><camera><horizontal_fov>1.0</horizontal_fov>
  <image><width>8</width><height>6</height></image><clip><near>0.1</near><far>50</far></clip></camera>%s</sensor>"""
KINECT = """<plugin name='p' filename='libgazebo_ros_openni_kinect.so'><cameraName>kinect</cameraName>
  <imageTopicName>rgb/image_raw</imageTopicName><depthImageTopicName>depth/image_raw</depthImageTopicName>
  <pointCloudTopicName>depth/points</pointCloudTopicName><frameName>eye</frameName></plugin>"""
REALSENSE = """<gazebo><plugin name='d435' filename='librealsense_gazebo_plugin.so'><prefix>d</prefix>
  <depthTopicName>depth/image_raw</depthTopicName><colorTopicName>color/image_raw</colorTopicName>
  <rangeMinDepth>0.2</rangeMinDepth><rangeMaxDepth>10</rangeMaxDepth></plugin></gazebo>"""


def test_cameras_that_see_depth_publish_how_far_the_ground_is(cart):
    seen = EYE % ("eye", "depth", KINECT) + EYE % ("dcolor", "camera", "") + EYE % ("ddepth", "depth", "")
    urdf = ("<robot name='watcher'><link name='eye'/><gazebo><static>true</static></gazebo><gazebo reference='eye'>"
            + seen + "</gazebo>" + REALSENSE + "</robot>")
    down = {"position": {"x": -5.0, "z": 2.0}, "orientation": {"y": 0.7071067811865476, "w": 0.7071067811865476}}
    told = cart.answer("/gazebo/spawn_urdf_model", yaml.safe_dump(
        {"model_name": "watcher", "model_xml": urdf, "initial_pose": down}))
    assert told["success"], told

    def pixels(topic, encoding, kind):
        image = cart.message(topic)
        assert (image["encoding"], image["height"], image["width"]) == (encoding, 6, 8)
        return numpy.frombuffer(bytes(image["data"]), dtype=kind)

    assert pixels("/kinect/depth/image_raw", "32FC1", "<f4") == pytest.approx(2.0, abs=1e-5)
    assert set(pixels("/d435/depth/image_raw", "16UC1", "<u2")) <= {1999, 2000}
    for topic in ("/kinect/rgb/image_raw", "/d435/color/image_raw"):
        assert len(pixels(topic, "rgb8", "u1")) == 144
    assert cart.message("/d435/depth/camera_info")["K"][2] == 4.0
    cloud = cart.message("/kinect/depth/points")
    assert [field["name"] for field in cloud["fields"]] == ["x", "y", "z", "rgb"]
    points = numpy.frombuffer(bytes(cloud["data"]), dtype="<f4").reshape(6, 8, 4)
    assert points[..., 2] == pytest.approx(2.0, abs=1e-5)
    assert points[0, 0, :2] == pytest.approx(2.0 * numpy.array([-3.5, -2.5]) * numpy.tan(0.5) / 4.0, rel=1e-5)
    assert cart.answer("/gazebo/delete_model", "{model_name: watcher}")["success"]


def test_a_wrench_from_outside_lifts_the_cart_and_ends(cart):
    lift = "{body_name: 'cart::base_link', wrench: {force: {z: 60.0}}, duration: {secs: -1, nsecs: 0}}"
    assert cart.answer("/gazebo/apply_body_wrench", lift)["success"]
    cart.until(lambda: place(cart)["z"] > 0.2, "it rises")
    cart.answer("/gazebo/clear_body_wrenches", "cart::base_link")
    # How high the cart has risen by now depends on how fast the machine is, and so does how long it falls. This test
    # sees that it falls, then puts it at 0.3 m and sees it come down to the ground.
    cart.until(lambda: state(cart)["twist"]["linear"]["z"] < 0.0, "it falls")
    raised = "{model_state: {model_name: cart, pose: {position: {z: 0.3}}}}"
    assert cart.answer("/gazebo/set_model_state", raised)["success"]
    cart.until(lambda: abs(place(cart)["z"]) < 0.01, "it fell down again")


def test_a_root_link_is_placed_and_its_mass_is_told(cart):
    assert cart.answer("/gazebo/get_link_properties", "{link_name: load}")["mass"] == 0.5
    assert cart.answer("/gazebo/set_link_state",
                       "{link_state: {link_name: base_footprint, pose: {position: {y: 3.0}}}}")["success"]
    load = cart.answer("/gazebo/get_link_state", "{link_name: 'cart::load'}")["link_state"]
    assert abs(load["pose"]["position"]["y"] - 3.0) < 0.05


def test_properties_that_are_set_are_told_again_and_act(cart):
    load = cart.answer("/gazebo/get_link_properties", "{link_name: load}")
    load.update(link_name="load", mass=0.8)
    told = cart.answer("/gazebo/set_link_properties", yaml.safe_dump(
        {key: value for key, value in load.items() if key not in ("success", "status_message")}))
    assert told["success"], told
    assert cart.answer("/gazebo/get_link_properties", "{link_name: load}")["mass"] == 0.8
    cart.until(lambda: abs(cart.message("/load_ft")["wrench"]["force"]["z"] + 0.8 * 9.81) < 0.05, "it weighs more")
    assert cart.answer("/gazebo/set_joint_properties",
                       "{joint_name: left_wheel_joint, ode_joint_config: {damping: [0.01], erp: [0.2]}}")["success"]
    assert cart.answer("/gazebo/get_joint_properties", "{joint_name: left_wheel_joint}")["damping"] == [0.01]
    physics = cart.answer("/gazebo/get_physics_properties")
    wanted = {key: physics[key] for key in ("time_step", "max_update_rate", "gravity", "ode_config")}
    wanted["gravity"]["z"], wanted["time_step"] = -4.9, 0.002
    assert cart.answer("/gazebo/set_physics_properties", yaml.safe_dump(wanted))["success"]
    physics = cart.answer("/gazebo/get_physics_properties")
    assert (physics["gravity"]["z"], physics["time_step"]) == (-4.9, 0.002)
    cart.until(lambda: abs(cart.message("/imu")["linear_acceleration"]["z"] - 4.9) < 0.05, "it is lighter")


def test_a_saved_world_comes_back_as_it_was(cart):
    cart.answer("/gazebo/pause_physics")
    before = cart.answer("/gazebo/get_model_state", "{model_name: cart}")["pose"]
    kept = cart.answer("/gazebo/save_state", "{name: here}")
    assert kept["success"] and kept["name"] == "here"
    box = "<robot name='b'><link name='l'/><gazebo><static>true</static></gazebo></robot>"
    assert cart.answer("/gazebo/spawn_urdf_model", yaml.safe_dump({"model_name": "box", "model_xml": box}))["success"]
    assert cart.answer("/gazebo/set_model_state",
                       "{model_state: {model_name: cart, pose: {position: {y: -2.0, z: 1.0}}}}")["success"]
    told = cart.answer("/gazebo/restore_state", "{name: here}")
    assert told["success"], told
    assert cart.answer("/gazebo/get_model_state", "{model_name: cart}")["pose"] == before
    assert "box" not in cart.answer("/gazebo/get_world_properties")["model_names"]
    assert not cart.answer("/gazebo/restore_state", "{name: there}")["success"]
    cart.answer("/gazebo/unpause_physics")
    cart.until(lambda: cart.message("/odom"), "the cart publishes")


@pytest.mark.parametrize("service, request_, text", [
    ("set_link_properties", "{link_name: load, mass: -1.0}", "mass"),
    ("set_joint_properties", "{joint_name: moon}", "joint not found"),
    ("set_joint_properties", "{joint_name: left_wheel_joint, ode_joint_config: {vel: [3.0]}}", "vel: found 3"),
    ("set_physics_properties", "{time_step: 0.0}", "time_step: found 0 s"),
    ("apply_body_wrench", "{body_name: base_link, wrench: {force: {x: .nan}}}", "not finite"),
    ("apply_joint_effort", "{joint_name: left_wheel_joint, effort: .inf}", "ApplyJointEffort: effort"),
    ("apply_body_wrench", "{body_name: base_link, reference_frame: moon}", "reference_frame not found"),
    ("set_link_state", "{link_state: {link_name: moon}}", "SetLinkState: link does not exist")])
def test_what_cannot_be_is_refused_and_the_world_goes_on(cart, service, request_, text):
    told = cart.answer("/gazebo/" + service, request_)
    assert not told["success"] and text in told["status_message"], told
    before = cart.answer("/gazebo/get_world_properties")["sim_time"]
    cart.until(lambda: cart.answer("/gazebo/get_world_properties")["sim_time"] > before, "time goes on")


def test_a_base_drives_by_its_controller(tmp_path_factory):
    with Graph(tmp_path_factory.mktemp("ros")) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "demo_cart", "controlled.launch")
        graph.until(lambda: "Started controllers" in graph.log(), "the controllers run")
        listed = graph.answer("/cart/controller_manager/list_controllers")["controller"]
        assert {each["name"]: each["type"] for each in listed}["base_controller"] == \
            "diff_drive_controller/DiffDriveController"
        graph.start("rostopic", "pub", "-1", "/cart/base_controller/cmd_vel", "geometry_msgs/Twist",
                    "{linear: {x: 5.0}, angular: {z: 0.3}}")
        graph.until(lambda: graph.message("/cart/base_controller/odom")["twist"]["twist"]["linear"]["x"] > 0.29,
                    "it drives as fast as it may")
        odometry = graph.message("/cart/base_controller/odom")
        assert odometry["child_frame_id"] == "base_footprint" and odometry["pose"]["covariance"][35] == 0.03
        assert odometry["twist"]["twist"]["linear"]["x"] == pytest.approx(0.3, abs=0.01)
        assert odometry["twist"]["twist"]["angular"]["z"] == pytest.approx(0.3, abs=0.02)
        assert not graph.answer("/cart/controller_manager/load_controller", "{name: without_wheels}")["ok"]
        assert "right_wheel: found None" in graph.log()
