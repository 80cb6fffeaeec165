"""What the coverage renderer does not draw is said once, by part and name."""

import math

import pytest
from test_simulation import make

from aras_visual_servo_sim import Simulation

CAMERA = {"frame": "eye_optical_frame", "width": 16, "height": 12, "horizontal_fov_rad": 1.0}
BOTH = [{**CAMERA, "name": "exact"}, {**CAMERA, "name": "shown", "renderer": "opengl"}]
LAMP = {"name": "lamp", "sphere_m": 0.05, "material": {"emissive_rgb": [255, 0, 0], "opacity": 0.5}}
BEGIN = "camera 'exact': renderer coverage does not draw "


def scene(**changes):
    return {"background_rgb": [200, 200, 200], "models": [], **changes}


def undrawn(sim):
    return [line for line in sim.warnings if "renderer coverage" in line]


def test_parts_at_their_defaults_are_not_mentioned():
    assert undrawn(make(cameras=BOTH, scene=scene(solids=[{"name": "box", "box_m": [0.1, 0.1, 0.1]}]))) == []


def test_a_camera_of_opengl_leaves_nothing_out():
    assert undrawn(make(cameras=BOTH[1:], scene=scene(solids=[LAMP]))) == []


def test_materials_are_named_at_the_start_and_when_they_are_spawned_once():
    sim = make(cameras=BOTH, scene=scene(solids=[LAMP]))
    assert undrawn(sim) == [BEGIN + "emissive of lamp; opacity of lamp"]
    shiny = {"name": "shiny", "box_m": [0.1, 0.1, 0.1],
             "material": {"specular_rgb": [9, 9, 9], "ambient_share": 0.5, "two_sided": True}}
    sim.spawn_model(shiny)
    told = BEGIN + "ambient colour of shiny; specular of shiny; the back of two-sided faces of shiny"
    assert undrawn(sim)[1:] == [told]
    sim.delete_model("shiny")
    sim.spawn_model(shiny)
    sim.reset()
    assert len(undrawn(sim)) == 2


def test_lights_shadows_fog_and_sky_are_named():
    sun = {"name": "sun", "type": "directional", "direction": [0, 0, -1]}
    spot = {"name": "spot", "type": "spot", "direction": [0, 0, -1], "casts_shadows": False}
    sim = make(cameras=BOTH, scene=scene(lighting={
        "lights": [sun, spot], "fog": {"color_rgb": [0, 0, 0], "density_per_m": 0.1}, "zenith_rgb": [0, 0, 255]}))
    assert undrawn(sim) == [BEGIN + "fog; light of spot, sun; shadows of sun; sky"]
    sim.set_light({"name": "bulb", "type": "point"})
    assert undrawn(sim)[1:] == [BEGIN + "light of bulb; shadows of bulb"]


def test_a_normal_map_is_named(tmp_path):
    import cv2
    import numpy
    for name in ("bumps", "colours"):
        cv2.imwrite(str(tmp_path / (name + ".png")), numpy.full((4, 4, 3), 128, numpy.uint8))
    (tmp_path / "m.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd colours.png\nnorm bumps.png\n")
    (tmp_path / "m.obj").write_text("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                    "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n")
    sim = make(cameras=BOTH, scene=scene(solids=[{"name": "wall", "mesh": str(tmp_path / "m.obj")}]))
    assert any("normal map of wall" in line for line in undrawn(sim))


HEIGHT_M, WIDTH, ROWS, FIELD_RAD, TURN_RAD = 1.5, 160, 121, 1.0, 0.4
#: A camera that looks along the horizon, askew to the edges of the box.
URDF = f"""<robot name="r"><link name="base"/><link name="eye"/><joint name="j" type="fixed"><parent link="base"/>
<child link="eye"/><origin xyz="0 0 {HEIGHT_M}" rpy="{-math.pi / 2} 0 {TURN_RAD}"/></joint></robot>"""
SKY, GROUND = (10, 20, 30), 200


@pytest.mark.parametrize("renderer", ["coverage", "opengl"])
def test_a_box_of_ten_kilometres_is_a_ground_to_the_horizon(renderer):
    camera = {"name": "eye", "frame": "eye", "width": WIDTH, "height": ROWS, "horizontal_fov_rad": FIELD_RAD,
              "far_m": 1.0e4, "renderer": renderer}
    ground = {"name": "ground", "box_m": [1.0e4, 1.0e4, 1.0], "position_m": [0, 0, -0.5],
              "color_rgb": [255, 255, 255], "material": {"casts_shadows": False}}
    light = {"ambient_rgb": [GROUND] * 3, "lights": [{"name": "moon", "type": "point", "intensity": 0.0}]}
    sim = Simulation(URDF, {"cameras": [camera], "scene": {"background_rgb": list(SKY), "lighting": light,
                                                           "solids": [ground]}})
    image, depth = sim.render("eye").astype(int), sim.render_depth("eye")
    horizon, focal_px = (ROWS - 1) / 2, WIDTH / 2 / math.tan(FIELD_RAD / 2)
    for column in (0, WIDTH // 2, WIDTH - 1):
        assert (image[:int(horizon), column] == SKY).all()
        below = image[int(horizon) + 1:, column]
        assert (below == below[-1]).all(), "the same light up to the row below the horizon"
        assert renderer == "coverage" or (below == GROUND).all()
        for row in (62, 70, 100, 120):
            assert depth[row, column] == pytest.approx(HEIGHT_M * focal_px / (row - horizon), rel=1e-5)
