"""What a page is told of a run, whether it goes on in this process or over ROS: plain lists and dicts, for JSON."""

import math

import numpy as np
import yaml

from aras_visual_servo import TWIST_NAMES, known_features, known_laws, scenario_schema, spatial, styles
from .settings import AT_ONCE, changed
from .view.projection import project, standpoint
from .view.robot import robot_of
from .view.scene import scene_of


def about(scenario, kinematics, camera_info, servo, at_C, X_WT, target):
    """What a page has to know before anything moves, dict.

    Args:
        scenario: `Scenario`.  kinematics, servo: of it.  camera_info: dict as `Simulation.camera_info`.
        at_C: (3,) where the camera is [m].  X_WT: (4, 4) pose of the target, or None.  target: its name, or None.
    """
    features = [{"name": style.name, "symbol": style.symbol, "label": style.label, "unit": style.unit,
                 "factor": style.factor, "read_unit": style.read_unit, "colour": style.colour, "threshold": threshold}
                for style, threshold in zip(styles(servo.feature_names), servo.config.thresholds)]
    return {
        **drawn(scenario, kinematics, camera_info, at_C, X_WT, target), "features": features,
        "scenario": scenario.name, "description": scenario.description,
        "rows": row_names(kinematics.joint_names, servo.feature_names),
        "schema": scenario_schema()["properties"], "at_once": list(AT_ONCE),
        "choices": {"servo.law": known_laws(), "servo.features": known_features()}}


def drawn(scenario, kinematics, camera_info, at_C, X_WT, target):
    """The part of `about` that the 3-D view needs; arguments as there."""
    eye, look_at = standpoint(at_C, at_C * [1, 1, 0] if X_WT is None else X_WT[:3, 3])
    robot, scene = robot_of(scenario.urdf_xml()), scene_of(scenario)
    return {
        "robot": {**robot, "meshes": list(robot["meshes"])}, "tip": scenario.robot["tip_link"],
        "floating": not kinematics.spare_motion,
        "joints": [{"name": name, "lower": _finite(low), "upper": _finite(high)}
                   for name, low, high in zip(kinematics.joint_names, kinematics.lower, kinematics.upper)],
        "camera": {"width": camera_info["width"], "height": camera_info["height"], "K": list(camera_info["K"])},
        "scene": scene, "target": target, "notes": scene["notes"],
        "observer": {"eye": [float(x) for x in eye], "look_at": [float(x) for x in look_at]}}


def row_names(joint_names, feature_names):
    """Names of the numbers of `row`."""
    return ["t", *(f"e.{name}" for name in feature_names), *(f"v.{name}" for name in TWIST_NAMES),
            *(f"q.{name}" for name in joint_names), "condition", "manipulability", "real_time_factor",
            "x", "y", "z", "u", "v"]


def row(record, q, real_time_factor, at_C, marks):
    """The numbers of one image that curves show, None where one does not exist.

    Args: record: `ServoRecord`.  q: (n,) joints.  at_C: (3,) place of the camera.  marks: of the image.
    """
    numbers = [record.stamp_ns * 1e-9, *record.e, *record.twist, *q, record.cond_l, record.manipulability,
               real_time_factor, *at_C]
    return [rounded(x) for x in numbers] + list(marks["centre"] or (None, None))


def marks_of(features, camera_info):
    """What is drawn into an image: dict centre [u, v] or None, axis [rad] or None, points [[u, v], ...], in px."""
    if features is None or not features.target_visible:
        return {"centre": None, "axis": None, "points": []}
    xy = [(features.xg, features.yg), *zip(features.point_x, features.point_y)]
    pixels = project(np.array(xy, dtype=float), camera_info)
    pixels = [[round(float(u), 2), round(float(v), 2)] if math.isfinite(u) and math.isfinite(v) else None
              for u, v in pixels]
    return {"centre": pixels[0], "axis": rounded(features.alpha), "points": [p for p in pixels[1:] if p]}


def saved(scenario, name, X_WT, target, start):
    """YAML of the scenario with its target at X_WT, (4, 4), and the start at these joints, dict, unless None."""
    values = {"name": name}
    for key, path in (("urdf", scenario.urdf_path), ("controllers", scenario.controllers_path)):
        given = scenario.robot[key]
        values[f"robot.{key}"] = given if given.startswith("package://") else str(path.resolve())
    for i, model in enumerate(scenario.sim.get("scene", {}).get("models", [])):
        if model["name"] == target and {"motion", "attached_to"}.isdisjoint(model):
            values[f"sim.scene.models.{i}.position_m"] = [round(float(x), 6) for x in X_WT[:3, 3]]
            values[f"sim.scene.models.{i}.rpy_rad"] = [round(x, 7) for x in spatial.rpy_of(X_WT[:3, :3])]
    if start is not None:
        values["experiment.start"] = {"joints": {name: round(float(x), 7) for name, x in start.items()}}
    content = changed(scenario, values).as_dict()
    return (f"# Saved from the live page, from the scenario {scenario.name}.\n"
            + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, default_flow_style=None))


def rounded(value):
    """Six digits are more than a screen shows; JSON knows no NaN."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _finite(value):
    return float(value) if math.isfinite(value) else None
