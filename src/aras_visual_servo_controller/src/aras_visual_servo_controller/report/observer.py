"""A camera beside the arm. It renders a run from the recorded joint positions, as somebody standing there saw it."""

import math

import numpy as np

from ..ground.errors import ArasError
from ..live.view.projection import standpoint
from ..scenario.scenario import scenario_from_dict
from ..config.files import package_paths

NAME = "observer"
FIELD_RAD = 0.95                                               # horizontal field of view
FLOOR_RGB, TABLE_RGB, BACKGROUND_RGB = [204, 208, 214], [236, 236, 232], [226, 231, 238]


class ObserverError(ArasError):
    """The view cannot be rendered. The text says what the record lacks."""


class Observer:
    """Renders the robot of a record, at any of its rows, from the side.

    Args:
        record: RunRecord with settings. Where the observer stands follows from its camera poses and target pose.
        width, height: of the picture [px].
    Raises:
        ObserverError: the record does not name its robot and scene, or their files are missing here.
    """

    def __init__(self, record, width=640, height=480):
        from aras_visual_servo_sim import Simulation
        if not record.settings:
            raise ObserverError("the record does not hold its scenario, so nobody knows which robot it shows")
        path = record.X_WC[record.servo_rows, :3, 3]
        known = path[np.all(np.isfinite(path), axis=1)]
        # A pose read from a bag was a quaternion and differs in its last digits. Rounded, it gives the same picture.
        at_C = np.round(known.mean(axis=0), 4) if len(known) else np.array([0.0, 0.0, 1.0])
        at_T = at_C * [1, 1, 0] if record.X_WT is None else np.round(record.X_WT[:3, 3], 4)
        try:
            scenario = scenario_from_dict(record.settings)
            eye, look_at = standpoint(at_C, at_T)
            self._sim = Simulation(with_stand(scenario.urdf_xml(), eye, look_at),
                                   self._config(scenario, at_T, width, height), scenario.controllers(), package_paths())
        except RuntimeError as error:  # the simulator's and ours
            raise ObserverError(f"the robot of the record cannot be shown: {error}") from error
        self._names = record.joint_names

    @staticmethod
    def _config(scenario, at_T, width, height):
        config = dict(scenario.sim, cameras=[{
            "name": NAME, "frame": NAME, "width": width, "height": height, "horizontal_fov_rad": FIELD_RAD,
            "rate_hz": 30.0, "near_m": 0.05, "far_m": 50.0}])
        floor = _square("floor", 6.0, [at_T[0], at_T[1], min(0.0, at_T[2] - 0.01)], FLOOR_RGB)
        table = _square("table", 0.5, [at_T[0], at_T[1], at_T[2] - 0.0015], TABLE_RGB)
        scene = dict(scenario.sim["scene"], background_rgb=BACKGROUND_RGB)
        scene["models"] = [floor, table, *scene.get("models", [])]
        config["scene"] = scene
        return config

    def picture(self, q):
        """The view with the joints at q, (m,) in the record's order: uint8 (height, width, 3), the caller's own."""
        self._sim.set_joint_positions({name: float(x) for name, x in zip(self._names, q) if math.isfinite(x)})
        return np.array(self._sim.render(NAME))


def with_stand(urdf_xml, eye, look_at):
    """The URDF with a link NAME at `eye` whose z axis looks at `look_at`, x to the right, world z up in the picture."""
    z = (look_at - eye) / np.linalg.norm(look_at - eye)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    R = np.column_stack([x, np.cross(z, x), z])
    rpy = math.atan2(R[2, 1], R[2, 2]), -math.asin(max(-1.0, min(1.0, R[2, 0]))), math.atan2(R[1, 0], R[0, 0])
    root = _root_link(urdf_xml)
    stand = (f'<link name="{NAME}"/><joint name="{NAME}_stand" type="fixed"><parent link="{root}"/>'
             f'<child link="{NAME}"/><origin xyz="%.9g %.9g %.9g" rpy="%.9g %.9g %.9g"/></joint></robot>'
             % (*eye, *rpy))
    head, _, _ = urdf_xml.rpartition("</robot>")
    return head + stand


def _root_link(urdf_xml):
    import xml.etree.ElementTree as tree
    robot = tree.fromstring(urdf_xml)
    children = {joint.find("child").get("link") for joint in robot.findall("joint")}
    return next(link.get("name") for link in robot.findall("link") if link.get("name") not in children)


def _square(name, half_m, position_m, color_rgb):
    corners = [[-half_m, -half_m], [half_m, -half_m], [half_m, half_m], [-half_m, half_m]]
    return {"name": f"observer_{name}", "outlines_m": [corners], "color_rgb": color_rgb,
            "position_m": [float(x) for x in position_m], "rpy_rad": [0.0, 0.0, 0.0]}
