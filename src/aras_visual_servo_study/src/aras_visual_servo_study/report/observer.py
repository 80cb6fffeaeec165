"""A camera beside the arm. It renders a run from the recorded joint positions, as an observer there saw it.

OpenGL draws it, with light and shadow; where there is no OpenGL, the coverage renderer does, without shadows.
"""

import math

import numpy as np

from aras_visual_servo import ArasError, RunRecord, scenario_from_dict, simulation_of
from ..live.view.projection import middle, standpoint
from ..live.view.robot import robot_of

NAME = "observer"
FIELD_RAD = 0.95                                               # horizontal field of view
FLOOR_RGB, TABLE_RGB, BACKGROUND_RGB, ZENITH_RGB = [186, 191, 199], [240, 238, 232], [222, 228, 236], [150, 172, 200]
# A lamp behind the observer's right shoulder, so low that the gantry's shadow misses the arm, and a weak one without
# shadows from the left. Haze hides where the floor ends.
LIGHTING = {
    "ambient_rgb": [84, 87, 92], "shadow_map_px": 2048, "zenith_rgb": ZENITH_RGB,
    "fog": {"color_rgb": BACKGROUND_RGB, "density_per_m": 0.05},
    "lights": [{"name": "key", "type": "directional", "direction": [-0.62, -0.2, -1.0], "color_rgb": [182, 177, 168],
                "specular_rgb": [150, 150, 150]},
               {"name": "fill", "type": "directional", "direction": [0.3, 0.9, -0.4], "color_rgb": [60, 64, 70],
                "casts_shadows": False}]}


class ObserverError(ArasError):
    """The view cannot be rendered. The text says what the record lacks."""


class Observer:
    """Renders the robot of a record, at any of its rows, from the side.

    Args:
        record: RunRecord with settings. Where the observer stands follows from its camera poses and target pose.
        width, height: of the picture [px].
    Raises: ObserverError: the record does not name its robot and scene, or their files are missing here.
    """

    def __init__(self, record: RunRecord, width: int = 640, height: int = 480) -> None:
        if not record.settings:
            raise ObserverError("the record has no scenario, so its robot is unknown")
        at_C = middle(record.X_WC[record.servo_rows, :3, 3])
        at_T = at_C * [1, 1, 0] if record.X_WT is None else np.round(record.X_WT[:3, 3], 4)
        try:
            scenario = scenario_from_dict(record.settings)
            eye, look_at = standpoint(at_C, at_T)
            self._sim = simulation_of(scenario, with_stand(scenario.urdf_xml(), eye, look_at),
                                      self._config(scenario, at_T, width, height))
        except RuntimeError as error:  # the simulator's and ours
            raise ObserverError(f"the robot of the record cannot be shown: {error}") from error
        self._names = record.joint_names

    @staticmethod
    def _config(scenario, at_T, width, height):
        config = dict(scenario.sim, cameras=[{
            "name": NAME, "frame": NAME, "width": width, "height": height, "horizontal_fov_rad": FIELD_RAD,
            "rate_hz": 30.0, "near_m": 0.05, "far_m": 60.0, "renderer": _renderer(), "quality": "high"}])
        carried = scenario.robot.get("target_link") is not None
        table_m = at_T[2] - 0.0015
        floor = _slab("floor", 80.0, 0.01, [at_T[0], at_T[1], min(0.0, table_m - 0.05)], FLOOR_RGB)
        table = _slab("table", 1.2, 0.02, [at_T[0], at_T[1], table_m], TABLE_RGB)
        scene = dict(scenario.sim["scene"], background_rgb=BACKGROUND_RGB)
        scene["solids"] = [floor, *([] if carried else [table]), *scene.get("solids", [])]
        if not scene.get("lighting", {}).get("lights"):
            scene["lighting"] = LIGHTING
        config["scene"] = scene
        return config

    @property
    def drawn_by(self) -> str:
        """What drew the pictures so far by OpenGL, and its version; "" if nothing did."""
        return self._sim.opengl

    def picture(self, q: np.ndarray) -> np.ndarray:
        """The view with the joints at q, (m,) in the record's order: uint8 (height, width, 3), the caller's own."""
        self._sim.set_joint_positions({name: float(x) for name, x in zip(self._names, q) if math.isfinite(x)})
        return np.array(self._sim.render(NAME))


def with_stand(urdf_xml: str, eye: np.ndarray, look_at: np.ndarray) -> str:
    """The URDF with a link NAME at `eye` whose z axis looks at `look_at`, x to the right, world z up in the picture."""
    z = (look_at - eye) / np.linalg.norm(look_at - eye)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    R = np.column_stack([x, np.cross(z, x), z])
    rpy = math.atan2(R[2, 1], R[2, 2]), -math.asin(max(-1.0, min(1.0, R[2, 0]))), math.atan2(R[1, 0], R[0, 0])
    root = robot_of(urdf_xml)["root"]
    stand = (f'<link name="{NAME}"/><joint name="{NAME}_stand" type="fixed"><parent link="{root}"/>'
             f'<child link="{NAME}"/><origin xyz="%.9g %.9g %.9g" rpy="%.9g %.9g %.9g"/></joint></robot>'
             % (*eye, *rpy))
    head, _, _ = urdf_xml.rpartition("</robot>")
    return head + stand


def _renderer():
    from aras_visual_servo_sim import RenderError, opengl_description
    try:
        opengl_description()
    except RenderError:
        return "coverage"
    return "opengl"


def _slab(name, width_m, height_m, top_m, color_rgb):
    """A square plate, top_m (3,): the middle of its upper side. It takes shadows and casts none."""
    x, y, z = (float(value) for value in top_m)
    return {"name": f"observer_{name}", "box_m": [width_m, width_m, height_m], "color_rgb": color_rgb,
            "position_m": [x, y, z - height_m / 2], "material": {"casts_shadows": False}}
