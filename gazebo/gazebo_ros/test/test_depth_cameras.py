"""Cameras that see depth, as the plugins of RealSense and Kinect publish it."""
import io

import numpy
import pytest
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from gazebo_ros.node.cameras import image_message
from gazebo_ros.world.depth_cameras import Depth
from gazebo_ros.world.description import read_description
from gazebo_ros.world.world import World
from test_world import at

EYE = """<sensor name='%s' type='%s'><update_rate>30</update_rate><camera name='camera'>
  <horizontal_fov>1.0</horizontal_fov><image><width>40</width><height>30</height><format>%s</format></image>
  <clip><near>0.1</near><far>100</far></clip></camera></sensor>"""
REALSENSE = """<robot name='r'><link name='base_link'/>
  <joint name='j' type='fixed'><parent link='base_link'/><child link='body'/></joint><link name='body'/>
  <joint name='c' type='fixed'><parent link='body'/><child link='color_frame'/>
    <origin rpy='-1.5707963267948966 0 -1.5707963267948966'/></joint><link name='color_frame'/>
  <gazebo><static>true</static></gazebo>
  <gazebo reference='body'>""" + EYE % ("camcolor", "camera", "RGB_INT8") + EYE % ("camired1", "camera", "L_INT8") + \
    EYE % ("camdepth", "depth", "") + """</gazebo>
  <gazebo><plugin name='head' filename='librealsense_gazebo_plugin.so'><prefix>cam</prefix>
    <depthTopicName>depth/image_raw</depthTopicName><colorTopicName>color/image_raw</colorTopicName>
    <infrared1TopicName>infra1/image_raw</infrared1TopicName>
    <colorOpticalframeName>color_frame</colorOpticalframeName><rangeMinDepth>0.3</rangeMinDepth>
    <rangeMaxDepth>%s</rangeMaxDepth><pointCloud>true</pointCloud><pointCloudCutoff>0.25</pointCloudCutoff>
    <pointCloudCutoffMax>9.0</pointCloudCutoffMax><pointCloudTopicName>depth/color/points</pointCloudTopicName>
  </plugin></gazebo></robot>"""
KINECT = """<robot name='k'><link name='body'/><gazebo><static>true</static></gazebo><gazebo reference='body'>
  <sensor name='eye' type='depth'><update_rate>20</update_rate><camera><horizontal_fov>1.0</horizontal_fov>
  <image><width>40</width><height>30</height></image><clip><near>0.05</near><far>8</far></clip></camera>
  <plugin name='p' filename='libgazebo_ros_%s.so'><cameraName>kinect</cameraName>
  <imageTopicName>rgb/image_raw</imageTopicName><cameraInfoTopicName>rgb/camera_info</cameraInfoTopicName>
  <depthImageTopicName>depth/image</depthImageTopicName><pointCloudCutoff>0.5</pointCloudCutoff>
  <pointCloudCutoffMax>3.0</pointCloudCutoffMax><frameName>body</frameName></plugin></sensor></gazebo></robot>"""


def test_a_realsense_has_the_topics_of_its_plugin():
    found = read_description(REALSENSE % "10.0", "", "r")
    cameras = found.cameras
    assert sorted(cameras) == ["camcolor", "camdepth", "camired1"]
    assert (cameras["camcolor"].image, cameras["camcolor"].info) == ("/head/color/image_raw", "/head/color/camera_info")
    assert cameras["camired1"].image == "/head/infra1/image_raw" and cameras["camcolor"].depth is None
    depth = cameras["camdepth"].depth
    assert (depth.image, depth.info, depth.points) == ("/head/depth/image_raw", "/head/depth/camera_info",
                                                       "/head/depth/color/points")
    assert depth.millimetres and depth.range_m == (0.3, 10.0) and depth.points_m == (0.25, 9.0)
    assert cameras["camdepth"].image == "" and depth.colors == "camcolor"
    assert [each for each in found.warnings if "sensor" in each or "plugin" in each] == [
        "plugin librealsense_gazebo_plugin.so: there is no sensor 'camired2'"]


def test_a_realsense_sees_color_and_depth_and_has_the_camera_info_of_the_plugin():
    world = World()
    model = world.spawn("r", REALSENSE % "10.0", pose=at(x=-1.0, z=1.0))
    core = world.core
    assert set(core.camera_names) == {"r::camcolor", "r::camdepth", "r::camired1"}
    info = core.camera_info("r::camcolor")
    assert info["frame_id"] == "color_frame" and (info["K"][2], info["K"][5]) == (20.0, 15.0)
    assert info["K"][0] == pytest.approx(20.0 / numpy.tan(0.5))
    assert core.camera_encoding("r::camired1") == "mono8" and core.camera_encoding("r::camcolor") == "rgb8"
    world.step(100)
    depth_m = core.render_depth("r::camdepth")
    below = depth_m[25, 20]  # looks along x, a metre above the ground
    assert below == pytest.approx(info["K"][0] / (25 - 14.5), rel=1e-3)
    values = model.description.cameras["camdepth"].depth.values(depth_m)
    assert values.dtype == numpy.uint16 and values[25, 20] == int(1000 * below) and values[5, 20] == 0


@pytest.mark.parametrize("kind, farthest", (("openni_kinect", 3.0), ("depth_camera", numpy.inf)))
def test_a_kinect_has_image_depth_and_points_of_one_sensor(kind, farthest):
    found = read_description(KINECT % kind, "", "k")
    topics, = found.cameras.values()
    assert (topics.image, topics.info) == ("/kinect/rgb/image_raw", "/kinect/rgb/camera_info")
    assert (topics.depth.image, topics.depth.info) == ("/kinect/depth/image", "/kinect/depth/camera_info")
    assert topics.depth.points == "/kinect/points" and topics.depth.range_m == (0.5, farthest)
    assert not topics.depth.millimetres and not any("plugin" in each or "sensor" in each for each in found.warnings)
    world = World()
    world.spawn("k", KINECT % kind, pose=at(z=1.0))
    assert list(world.core.camera_names) == ["k::kinect"]


def test_values_out_of_range_are_nothing():
    depth_m = numpy.array([[0.2, 0.5, 2.0, 70.0, numpy.nan]], dtype=numpy.float32)
    short = Depth("d", "i", "", True, (0.3, 100.0), (0.0, 1.0), "c")
    assert short.values(depth_m).tolist() == [[0, 500, 2000, 0, 0]]
    metres = Depth("d", "i", "", False, (0.3, 3.0), (0.0, 1.0), "c")
    found = metres.values(depth_m)
    assert found.dtype == numpy.float32 and numpy.isnan(found[0]).tolist() == [True, False, False, True, True]


def test_points_lie_where_their_pixels_look_and_have_their_colours():
    depth_m = numpy.full((4, 6), 2.0, dtype=numpy.float32)
    depth_m[0, 0] = 9.0
    colors = numpy.zeros((4, 6, 3), dtype=numpy.uint8)
    colors[3, 5] = 10, 20, 30
    cloud = Depth("d", "i", "p", True, (0.0, 1.0), (0.5, 5.0), "c")
    points = cloud.cloud(depth_m, [100.0] + [0.0] * 8, colors)
    assert points[3, 5, :3].tolist() == pytest.approx([2.0 * 2.5 / 100, 2.0 * 1.5 / 100, 2.0])
    assert points[3, 5, 3].view(numpy.uint32) == 10 << 16 | 20 << 8 | 30
    assert numpy.isnan(points[0, 0, :3]).all()
    assert (cloud.cloud(depth_m, [100.0] + [0.0] * 8, colors[:2])[..., 3] == 0.0).all()


def test_a_number_that_is_none_is_the_default():
    found = read_description(REALSENSE % "nan", "", "r")
    assert found.cameras["camdepth"].depth.range_m == (0.3, 65.535)
    assert any("<rangeMaxDepth> 'nan'" in line for line in found.warnings)


@pytest.mark.parametrize("image, encoding", [
    (numpy.arange(24, dtype=numpy.uint8).reshape(2, 4, 3), "rgb8"),
    (numpy.arange(8, dtype=numpy.float32).reshape(2, 4), "32FC1"),
    (numpy.arange(16, dtype=numpy.uint8).reshape(2, 8)[:, :4], "mono8")])
def test_an_image_is_sent_with_the_bytes_of_its_array(image, encoding):
    sent = io.BytesIO()
    image_message(Header(seq=3, frame_id="eye"), image, encoding).serialize(sent)
    got = Image().deserialize(sent.getvalue())
    assert (got.header.seq, got.header.frame_id, got.encoding, got.height, got.width) == (3, "eye", encoding, 2, 4)
    assert got.data == image.tobytes() and got.step == len(got.data) // 2
