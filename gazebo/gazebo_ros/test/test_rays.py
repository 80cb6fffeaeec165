"""Lasers: distances along rays, in the world and out of what a description says."""
import numpy
import pytest

from gazebo_ros.node.devices.outlet import Noise
from gazebo_ros.node.devices.sensors import scan
from gazebo_ros.world import snapshot
from gazebo_ros.world.description import read_description
from gazebo_ros.world.devices import directions_of, resampled
from gazebo_ros.world.poses import matrix_of, matrix_of_rpy
from gazebo_ros.world.world import World

ROUNDING_M = 1e-9
NOWHERE = (0.0, 0.0, 0.0, 1.0)

#: A post with a laser on its side; a shroud that only cameras and gpu lasers see, and a housing around the laser.
POST = """<robot name='post'><link name='world'/><link name='base'/>
  <joint name='foot' type='fixed'><parent link='world'/><child link='base'/></joint>
  <link name='scanner'>
    <collision><geometry><cylinder radius='0.05' length='0.1'/></geometry></collision>
    <visual><geometry><cylinder radius='0.05' length='0.1'/></geometry></visual></link>
  <joint name='mount' type='fixed'><parent link='base'/><child link='scanner'/>
    <origin xyz='0 0 0.5' rpy='0 0 0.3'/></joint>
  <gazebo reference='scanner'><sensor type='{kind}' name='laser'><pose>0.01 0 0.02 0 0 0</pose>
    <update_rate>10</update_rate><ray>
      <scan><horizontal><samples>{samples}</samples><resolution>{resolution}</resolution>
        <min_angle>-1.5</min_angle><max_angle>{highest}</max_angle></horizontal></scan>
      <range><min>0.1</min><max>8</max><resolution>0.01</resolution></range>
      <noise><type>gaussian</type><mean>0.0</mean><stddev>0.02</stddev></noise></ray>
    <plugin name='p' filename='libgazebo_ros_{plugin}.so'><topicName>scan</topicName><frameName>scanner</frameName>
    </plugin></sensor></gazebo></robot>"""
RAY = {"kind": "ray", "plugin": "laser", "samples": 181, "resolution": 1, "highest": 1.5}
GPU = {**RAY, "kind": "gpu_ray", "plugin": "gpu_laser"}
BALL = """<robot name='ball'><link name='ball'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0'
  ixz='0' iyz='0'/></inertial><collision><geometry><sphere radius='{hard}'/></geometry></collision>
  <visual><geometry><sphere radius='{soft}'/></geometry></visual></link>
  <gazebo reference='ball'><laserRetro>42</laserRetro></gazebo></robot>"""
BALL_AT = numpy.array((2.0, 0.5, 0.6))


def place(position):
    return matrix_of(position, NOWHERE, "test")


def measured(settings=RAY, ball=None):
    """Ranges and intensities of a post beside a ball; the device, the post and the world."""
    world = World()
    post = world.spawn("post", POST.format(**settings), "/robot")
    if ball is not None:
        world.spawn("ball", BALL.format(**ball), pose=place(BALL_AT))
    device = post.description.devices[0]
    return (*scan(world, post, device, directions_of(device.horizontal, device.vertical)), device, post, world)


def to_ball(device, post, radius):
    """Distances to the surface of the ball, by its equation."""
    X_WS = post.link_pose("scanner") @ device.X_LS
    rays = directions_of(device.horizontal, device.vertical) @ X_WS[:3, :3].T
    across = X_WS[:3, 3] - BALL_AT
    ahead = rays @ across
    inside = ahead ** 2 - (across @ across - radius ** 2)
    with numpy.errstate(invalid="ignore"):
        return numpy.where((inside > 0) & (ahead < 0), -ahead - numpy.sqrt(inside), numpy.inf)


def test_a_laser_has_the_angles_range_topic_and_frame_that_its_tags_say():
    device = measured()[2]
    assert (device.topic, device.frame, device.rate_hz) == ("/robot/scan", "scanner", 10.0)
    assert (device.range_min_m, device.range_max_m, device.noise, device.sees_visuals) == (0.1, 8.0, 0.02, False)
    assert device.horizontal.angles()[[0, 90, 180]] == pytest.approx([-1.5, 0.0, 1.5], abs=1e-12)
    assert measured(GPU)[2].sees_visuals


@pytest.mark.parametrize("settings, radius", [(RAY, 0.3), (GPU, 0.5)])
def test_ray_meets_collisions_and_gpu_ray_visuals(settings, radius):
    ranges, retros, device, post, _ = measured(settings, {"hard": 0.3, "soft": 0.5})
    expected = to_ball(device, post, radius)
    hit = numpy.isfinite(expected)
    assert 5 < hit.sum() < 60
    assert ranges[hit] == pytest.approx(expected[hit], abs=ROUNDING_M)
    assert numpy.isinf(ranges[~hit]).all(), "the housing is nearer than the range, the ground is farther"
    assert (retros[hit] == 42.0).all() and not retros[~hit].any()


def test_rays_meet_the_ground_and_what_moves_where_it_is():
    world = World()
    post = world.spawn("post", POST.format(**RAY), pose=matrix_of_rpy((0, 0, 0), (0, 0.2, 0)))
    device = post.description.devices[0]
    rays = directions_of(device.horizontal, device.vertical)
    ranges, _ = scan(world, post, device, rays)
    X_WS = post.link_pose("scanner") @ device.X_LS
    down = (rays @ X_WS[:3, :3].T)[:, 2]
    expected = numpy.where(down < 0, X_WS[2, 3] / numpy.where(down < 0, -down, 1.0), numpy.inf)
    seen = expected < 8.0
    assert seen.sum() > 50 and ranges[seen] == pytest.approx(expected[seen], abs=ROUNDING_M)
    ball = world.spawn("ball", BALL.format(hard=0.3, soft=0.3), pose=place((1.0, 0.0, 2.0)))
    assert scan(world, post, device, rays)[0][90] > 1.0
    ball.place(place(X_WS[:3, 3] + X_WS[:3, 0]), numpy.zeros(6))
    assert scan(world, post, device, rays)[0][90] == pytest.approx(0.7, abs=ROUNDING_M)
    world.delete("ball")
    assert (scan(world, post, device, rays)[0] == ranges).all()


def test_a_resolution_makes_numbers_between_the_rays():
    coarse = measured({**RAY, "samples": 91}, {"hard": 0.3, "soft": 0.3})
    fine = measured({**RAY, "samples": 91, "resolution": 2}, {"hard": 0.3, "soft": 0.3})
    assert len(fine[0]) == 182 and fine[2].horizontal.count == 182
    assert fine[0][0] == coarse[0][0] and fine[0][-1] == coarse[0][-1]
    scan_ = fine[2].horizontal
    assert resampled(scan_.angles(), scan_, fine[2].vertical) == pytest.approx(numpy.linspace(-1.5, 1.5, 182))


@pytest.mark.parametrize("change, text", [
    ({"samples": 0}, "found 0 samples"), ({"samples": 1e9}, "found 1e+09 samples"),
    ({"highest": -2.0}, "found angles from -1.5 to -2 rad")])
def test_a_laser_that_cannot_be_is_left_out_by_name(change, text):
    found = read_description(POST.format(**{**RAY, **change}), "", "post")
    assert not found.devices and any(text in line for line in found.warnings)


def test_a_number_of_a_laser_that_is_none_is_its_default():
    found = read_description(POST.format(**{**RAY, "highest": "nan", "lowest": -1.5}), "", "post")
    assert found.devices[0].horizontal.highest == 0.0 and any("<max_angle> 'nan'" in line for line in found.warnings)


#: A pyramid with its square base at x = 0 and its tip at x = 1, as an OBJ file; outside is counter-clockwise.
PYRAMID = """v 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nv 1 0 0
f 2 1 4\nf 2 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"""


@pytest.mark.parametrize("settings", [RAY, GPU])
@pytest.mark.parametrize("scale, nearest", [("1 1 1", 0.0), ("-1 1 1", -1.0), ("2 0.5 0.5", 0.0)])
def test_meshes_are_met_at_their_triangles_also_mirrored_and_scaled(tmp_path, settings, scale, nearest):
    (tmp_path / "pyramid.obj").write_text(PYRAMID)
    mesh = "<geometry><mesh filename='file://%s' scale='%s'/></geometry>" % (tmp_path / "pyramid.obj", scale)
    world = World()
    post = world.spawn("post", POST.format(**settings))
    world.spawn("pyramid", "<robot name='p'><link name='l'><visual>%s</visual><collision>%s</collision></link><gazebo>"
                "<static>true</static></gazebo></robot>" % (mesh, mesh), pose=place((3.0, 0.0, 0.52)))
    device = post.description.devices[0]
    ranges, _ = scan(world, post, device, directions_of(device.horizontal, device.vertical))
    X_WS = post.link_pose("scanner") @ device.X_LS
    rays = directions_of(device.horizontal, device.vertical) @ X_WS[:3, :3].T
    ahead = int(numpy.argmax(rays[:, 0]))
    assert X_WS[0, 3] + ranges[ahead] * rays[ahead, 0] == pytest.approx(3.0 + nearest, abs=0.05), "base or tip"


def test_noise_is_the_same_at_the_same_time_and_has_the_deviation_that_was_asked_for():
    noise = Noise("/scan", 0.02)
    first = noise(numpy.zeros(4000), 5)
    assert (Noise("/scan", 0.02)(numpy.zeros(4000), 5) == first).all()
    assert (noise(numpy.zeros(4000), 6) != first).any() and (Noise("/other", 0.02)(numpy.zeros(4000), 5) != first).any()
    assert first.std() == pytest.approx(0.02, rel=0.05), "4000 numbers: 1 % of deviation, five times"


def test_a_saved_world_sees_the_same():
    ranges, _, device, post, world = measured(RAY, {"hard": 0.3, "soft": 0.3})
    state = snapshot.saved(world)
    world.step(400)
    rays = directions_of(device.horizontal, device.vertical)
    assert (scan(world, post, device, rays)[0] != ranges).any(), "the ball fell"
    snapshot.restore(world, state)
    assert (scan(world, world.models["post"], device, rays)[0] == ranges).all()
