"""Lights through the Python binding."""
import pathlib

import pytest
import yaml

from aras_visual_servo_sim import ModelError, ParameterError, Simulation, UnknownNameError, light_entry

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "ros" / "robot"
SUN = {"name": "sun", "type": "directional", "direction": [0, 0, -1], "color_rgb": [40, 40, 40]}
LAMP = {"name": "lamp", "type": "point", "position_m": [0.0, 0.0, 0.4], "color_rgb": [255, 128, 0]}


def simulation():
    config = yaml.safe_load((FOLDER / "sim.yaml").read_text())["sim"]
    config["cameras"][0].update(renderer="opengl", encoding="rgb8")
    config["scene"]["solids"] = [{"name": "floor", "box_m": [2, 2, 0.01], "position_m": [0, 0, -0.1]}]
    config["scene"]["lighting"] = {"lights": [SUN]}
    return Simulation((FOLDER / "pan_lift.urdf").read_text(), config)


def test_lights_are_set_seen_and_deleted():
    sim = simulation()
    before = sim.render("camera").copy()
    sim.set_light(LAMP)
    assert sim.lights["lamp"]["position_m"] == [0.0, 0.0, 0.4] and sim.lights["lamp"]["type"] == "point"
    assert sim.lights["lamp"]["color_rgb"] == pytest.approx([255, 128, 0])
    lit = sim.render("camera").astype(int) - before
    assert lit[5, 5, 0] > lit[5, 5, 1] + 20 and lit[5, 5, 2] == 0, "orange light falls on the floor"
    sim.set_light(dict(sim.lights["lamp"], intensity=0.0))
    assert (sim.render("camera") == before).all()
    sim.delete_light("lamp")
    assert list(sim.lights) == ["sun"]


def test_sdf_is_read():
    entry = light_entry("<light name='1' type='spot'><spot><outer_angle>1</outer_angle></spot>"
                        "<cast_shadows>1</cast_shadows></light>")
    assert entry["name"] == "1" and entry["casts_shadows"] is True and entry["outer_angle_rad"] == 1.0
    sim = simulation()
    sim.set_light("<light name='1' type='spot'><spot><outer_angle>1</outer_angle></spot></light>")
    assert list(sim.lights) == ["sun", "1"]


@pytest.mark.parametrize("light, error, named", [
    (dict(LAMP, attached_to="nowhere"), ParameterError, "nowhere"),
    ({"name": "sun", "type": "directional"}, ParameterError, "direction"),
    ("<light name='a' type='laser'/>", ModelError, "laser"), ({"name": "a"}, ParameterError, "type")])
def test_what_cannot_be_is_named(light, error, named):
    sim = simulation()
    with pytest.raises(error, match=named):
        sim.set_light(light)
    with pytest.raises(UnknownNameError, match="lights: sun"):
        sim.delete_light("a")
