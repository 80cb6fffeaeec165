"""Lenses of wide-angle cameras."""
import math
import xml.etree.ElementTree as ElementTree

import numpy
import pytest

from gazebo_ros.world.lenses import NAMED, fitted, replace_lenses
from gazebo_ros.world.poses import matrix_of_rpy
from gazebo_ros.world.world import World

CUSTOM = ("<type>custom</type><custom_function><c1>1</c1><c2>2.05</c2><f>7.5</f><fun>tan</fun></custom_function>"
          "<scale_to_hfov>true</scale_to_hfov><cutoff_angle>2.84</cutoff_angle>")


def radius(polynomial, theta):
    return theta * (1.0 + sum(k * theta ** (2 * power + 2) for power, k in enumerate(polynomial)))


@pytest.mark.parametrize("c1, c2, c3, name, reach", [(1.0, 2.05, 0.0, "tan", 2.18), (2.0, 2.0, 0.0, "tan", 1.57),
                                                     (2.0, 2.0, 0.0, "sin", 2.18), (1.0, 1.0, 0.0, "sin", 1.4)])
def test_the_polynomial_is_the_function_over_all_angles_that_are_drawn(c1, c2, c3, name, reach):
    polynomial, wide, far = fitted(c1, c2, c3, 1.0, name, math.pi / 2, True, reach)
    assert far == pytest.approx(reach)
    function = {"tan": math.tan, "sin": math.sin}[name]
    focal = 2.0 / wide  # halves of the width
    for theta in numpy.linspace(0.05, far, 20):
        exact = function(theta / c2) / function(math.pi / 4 / c2)  # 1 at half the field, which is the edge
        assert focal * radius(polynomial, theta) == pytest.approx(exact, abs=2e-3), theta


def test_without_a_scale_the_focal_length_is_that_of_the_function():
    polynomial, wide, _ = fitted(1.5, 2.0, 0.0, 0.6, "id", 1.0, False, 1.0)
    assert 2.0 / wide == pytest.approx(1.5 * 0.6 / 2.0, rel=1e-5) and polynomial == pytest.approx((0.0,) * 4, abs=1e-6)


def lens_of(inside):
    robot = ElementTree.fromstring("<robot><gazebo reference='l'><sensor name='s' type='wideanglecamera'><camera>"
                                   "<horizontal_fov>3.0</horizontal_fov>%s</camera></sensor></gazebo></robot>" % inside)
    warnings = []
    replace_lenses(robot, warnings)
    return robot.find("gazebo/sensor/camera"), warnings


def test_all_types_become_one_and_a_wrong_one_is_named():
    for kind in NAMED:
        if kind in ("equidistant", "gnomonical"):  # the one stays, the other cannot see 3 rad
            continue
        camera, warnings = lens_of("<lens><type>%s</type></lens>" % kind)
        assert not warnings and camera.findtext("lens/type") == "equidistant", kind
        assert len(camera.findtext("lens/polynomial").split()) == 4
    assert lens_of("")[0].findtext("lens/polynomial") == lens_of("<lens><type>stereographic</type></lens>")[0].findtext(
        "lens/polynomial"), "SDF's default"
    camera, warnings = lens_of("<lens><type>strange</type></lens>")
    assert len(warnings) == 1 and "strange" in warnings[0] and camera.findtext("lens/type") == "equidistant"


def test_a_custom_lens_sees_a_wall_beside_it_where_the_function_says():
    """A black rod at 60 degrees beside the axis of a camera with a field of 180 degrees."""
    rod = ("<robot name='r'><link name='world'/><joint name='j' type='fixed'><parent link='world'/><child link='rod'/>"
           "</joint><link name='rod'><visual><geometry><cylinder radius='0.02' length='4'/></geometry></visual></link>"
           "<gazebo reference='rod'><material>Gazebo/Black</material></gazebo></robot>")
    eye = ("<sdf version='1.6'><model name='eye'><static>true</static><link name='l'><sensor name='s' "
           "type='wideanglecamera'><update_rate>10</update_rate><camera><horizontal_fov>3.14159</horizontal_fov><image>"
           "<width>320</width><height>40</height></image><clip><near>.1</near><far>100</far></clip><lens>%s</lens>"
           "</camera><plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>fisheye</cameraName></plugin>"
           "</sensor></link></model></sdf>" % CUSTOM)
    world = World()
    world.spawn("rod", rod, pose=matrix_of_rpy((math.cos(math.pi / 3), math.sin(math.pi / 3), 3.0), (0, 0, 0)))
    world.spawn_sdf("eye", eye, pose=matrix_of_rpy((0, 0, 3.0), (0, 0, 0)))
    row = world.core.render("eye::fisheye")[20].astype(float).sum(axis=1)
    dark = numpy.flatnonzero(row < 0.4 * row.max())
    expected = 159.5 - 160.0 * math.tan(math.pi / 3 / 2.05) / math.tan(math.pi / 2 / 2.05)
    assert dark.mean() == pytest.approx(expected, abs=1.0) and len(dark) < 12
