"""A ground to the horizon is a box of ten kilometres: as right near by as far away, with both renderers."""
import math

import pytest

from aras_visual_servo_sim import Simulation

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
