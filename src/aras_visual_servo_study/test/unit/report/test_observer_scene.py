"""What the observer of a video sees: where it stands, the floor and the table, the light, the robot's own scene."""
import math
import xml.etree.ElementTree as tree

import numpy as np
import pytest

from aras_visual_servo import Kinematics, load_scenario
from aras_visual_servo_study.report import observer
from aras_visual_servo_study.report.observer import LIGHTING, Observer, with_stand

pytest.importorskip("aras_visual_servo_sim")
ROBOT = '<robot name="r"><link name="base"/><link name="arm"/><joint name="j" type="revolute"><parent link="base"/>' \
        '<child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'


def scene_of(name, at_T, changes=None):
    config = Observer._config(load_scenario(name, changes or {}), np.array(at_T), 64, 48)
    return config["scene"], {solid["name"]: solid for solid in config["scene"]["solids"]}


@pytest.mark.parametrize("target_m, floor_m", [(0.4, 0.0), (0.02, 0.02 - 0.0515), (-0.3, -0.3515)])
def test_the_floor_is_that_of_the_world_or_five_centimetres_below_the_table(target_m, floor_m):
    _, solids = scene_of("experiment_1", [0.3, -0.2, target_m])
    floor, table = solids["observer_floor"], solids["observer_table"]
    for solid, top_m, width_m, height_m in ((floor, floor_m, 80.0, 0.01), (table, target_m - 0.0015, 1.2, 0.02)):
        assert solid["box_m"] == [width_m, width_m, height_m]
        assert solid["position_m"] == pytest.approx([0.3, -0.2, top_m - height_m / 2], abs=1e-12)
        assert solid["material"] == {"casts_shadows": False}


def test_a_target_that_the_arm_carries_stands_on_no_table():
    names = [scene_of(name, [0.0, 0.0, 0.5])[1] for name in ("experiment_1", "eye_to_hand")]
    assert [("observer_table" in one, "observer_floor" in one) for one in names] == [(True, True), (False, True)]


@pytest.mark.parametrize("own", [True, False])
def test_lights_of_the_scene_stay_and_a_scene_without_has_the_observers(own):
    lighting = {"ambient_rgb": [9, 9, 9], "lights": [{"name": "lamp", "type": "directional",
                                                      "direction": [0, 0, -1], "color_rgb": [9, 9, 9]}]}
    scene, _ = scene_of("experiment_1", [0, 0, 0.5], {"sim.scene.lighting": lighting} if own else {})
    assert (scene["lighting"] == LIGHTING) != own
    assert not own or [light["name"] for light in scene["lighting"]["lights"]] == ["lamp"]


@pytest.mark.parametrize("eye", [(2.0, -1.0, 1.5), (-1.0, 2.0, 0.2), (-1.5, -0.5, -1.0), (0.3, 3.0, 4.0)])
def test_the_observer_looks_from_where_it_stands_to_where_it_is_told_with_the_world_upright(eye):
    eye, look_at = np.array(eye), np.array([0.1, 0.2, 0.3])
    X = Kinematics(with_stand(ROBOT, eye, look_at).replace("</robot>", HELD), "base", "held").pose(np.zeros(1))
    np.testing.assert_allclose(X[:3, 3], eye, atol=1e-8)
    forward = (look_at - eye) / np.linalg.norm(look_at - eye)
    np.testing.assert_allclose(X[:3, 2], forward, atol=1e-7)
    assert abs(X[2, 0]) < 1e-7 and X[2, 1] < 0.0, "x is level, y points down"


#: Beyond the observer a joint, since a chain has at least one.
HELD = f'<link name="held"/><joint name="h" type="revolute"><parent link="{observer.NAME}"/><child link="held"/>' \
       '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'


def test_the_stand_is_fixed_to_the_link_that_nothing_carries():
    robot = tree.fromstring(with_stand(ROBOT, np.array([1.0, 0.0, 1.0]), np.zeros(3)))
    [stand] = [joint for joint in robot.findall("joint") if joint.get("name") == "observer_stand"]
    assert stand.find("parent").get("link") == "base" and stand.get("type") == "fixed"
    x, y, z = map(float, stand.find("origin").get("rpy").split())
    assert math.cos(x) < 0.0 and math.isfinite(y + z)
