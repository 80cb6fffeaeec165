"""The scene of a scenario as a page draws it: flat models with their outlines and pictures, and simple solids."""

import base64
import math
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np

from aras_visual_servo import RobotKinematics, ParameterError, Scenario, load_yaml, resolve_uri, spatial
from .projection import standpoint
from .robot import robot_of

WHITE, DARK, GREY, BACKGROUND = [255, 255, 255], [20, 20, 20], [128, 128, 128], [230, 230, 230]
KINDS = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".bmp": "image/bmp"}
#: The largest picture that is put into a page [bytes].
MOST_BYTES = 1_000_000


def drawn(scenario: Scenario, kinematics: RobotKinematics, camera_info: Dict[str, Any], at_C: np.ndarray,
          X_WT: Optional[np.ndarray], target: Optional[str]) -> Dict[str, Any]:
    """Returns what the 3-D view of a run needs, for JSON.

    Args: at_C: (3,) where the camera is in the world [m].  X_WT: (4, 4) pose of the target, whose name is `target`.
    """
    eye, look_at = standpoint(at_C, at_C * [1, 1, 0] if X_WT is None else X_WT[:3, 3])
    robot, scene = robot_of(scenario.urdf_xml()), scene_of(scenario)
    return {
        "robot": {**robot, "meshes": list(robot["meshes"])}, "tip": scenario.robot["tip_link"],
        "floating": not kinematics.spare_motion,
        "joints": [{"name": name, "lower": _finite(low), "upper": _finite(high)}
                   for name, low, high in zip(kinematics.joint_names, kinematics.lower, kinematics.upper)],
        "camera": {"width": camera_info["width"], "height": camera_info["height"], "K": list(camera_info["K"]),
                   "D": list(camera_info.get("D") or ()), "distortion_model": camera_info["distortion_model"]},
        "scene": scene, "target": target, "notes": scene["notes"],
        "observer": {"eye": [float(x) for x in eye], "look_at": [float(x) for x in look_at]}}


def _finite(value):
    return float(value) if math.isfinite(value) else None


def scene_of(scenario: Scenario) -> Dict[str, Any]:
    """Returns the scene: dict background, models, solids, notes.

    models: list of name, pose [x, y, z, qx, qy, qz, qw], color, outlines (lists of [x, y]), and, where there is one,
        board {size, color} and image {size, src}.  solids: list of name, pose, color, box, cylinder or sphere.
    notes: what is not shown, in words.  Lengths [m], colours 0 to 255.
    """
    section, base, notes = scenario.sim.get("scene", {}), scenario.path and Path(scenario.path).parent, []
    solids = []
    for solid in section.get("solids", []):
        shape = {name: solid[f"{name}_m"] for name in ("box", "cylinder", "sphere") if f"{name}_m" in solid}
        if not shape:
            notes.append(f"not drawn: solid '{solid['name']}', of a mesh or URDF")
            continue
        solids.append({"name": solid["name"], "pose": _pose(solid), "color": solid.get("color_rgb", GREY), **shape})
    models = section.get("models", [])
    for carried in [model for model in models[1:] if "attached_to" in model]:  # where the first is, pages are told
        notes.append(f"not drawn: model '{carried['name']}', which a link carries")
    models = [model for number, model in enumerate(models) if number == 0 or "attached_to" not in model]
    return {"background": section.get("background_rgb", BACKGROUND), "solids": solids, "notes": notes,
            "models": [_model(model, base, notes) for model in models]}


def pose_numbers(X: Optional[np.ndarray]) -> Optional[List[float]]:
    """Returns [x, y, z, qx, qy, qz, qw] of a pose (4, 4), rounded to a micrometre and a microradian; None of None."""
    if X is None:
        return None
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = X.tolist()
    return [round(value, 6) for value in (x, y, z, *_quaternion(a, b, c, d, e, f, g, h, i))]


def _quaternion(a, b, c, d, e, f, g, h, i):
    """(qx, qy, qz, qw) of a rotation matrix, row by row (Shepperd 1978).

    The library takes a tenth of a millisecond, and this is asked for a hundred times a second.
    """
    trace, largest = a + e + i, max(a, e, i)
    if trace > largest:
        w = 0.5 * math.sqrt(max(0.0, 1.0 + trace))
        return (h - f) / (4.0 * w), (c - g) / (4.0 * w), (d - b) / (4.0 * w), w
    if a == largest:
        x = 0.5 * math.sqrt(max(0.0, 1.0 + a - e - i))
        return x, (b + d) / (4.0 * x), (c + g) / (4.0 * x), (h - f) / (4.0 * x)
    if e == largest:
        y = 0.5 * math.sqrt(max(0.0, 1.0 + e - a - i))
        return (b + d) / (4.0 * y), y, (f + h) / (4.0 * y), (c - g) / (4.0 * y)
    z = 0.5 * math.sqrt(max(0.0, 1.0 + i - a - e))
    return (c + g) / (4.0 * z), (f + h) / (4.0 * z), z, (d - b) / (4.0 * z)


def _pose(entry):
    R = spatial.rotation_rpy(entry.get("rpy_rad", [0.0, 0.0, 0.0]))
    return [*entry.get("position_m", [0.0, 0.0, 0.0]), *(float(x) for x in spatial.quaternion_xyzw(R))]


def _model(entry, base, notes):
    shape, folder = dict(entry), base
    if "file" in entry:
        path = resolve_uri(entry["file"], base, "file")
        shape, folder = {**load_yaml(path), **entry}, path.parent
    model = {"name": entry["name"], "pose": _pose(entry), "color": shape.get("color_rgb", DARK),
             "outlines": shape.get("outlines_m", [])}
    if "board" in shape:
        model["board"] = {"size": shape["board"]["size_m"], "color": shape["board"].get("color_rgb", WHITE)}
    if "image" in shape:
        model["image"] = {"size": shape["image"]["size_m"], "src": _picture(shape["image"]["file"], folder, notes)}
    return model


def _picture(file, folder, notes):
    """The picture as a data: address, "" with a note where it cannot be shown."""
    try:
        path = resolve_uri(file, folder, "picture")
        kind = KINDS.get(path.suffix.lower())
        if kind is None or path.stat().st_size > MOST_BYTES:
            raise ParameterError(f"{file}: found {path.stat().st_size} bytes, allowed for a page: PNG, JPEG or BMP up "
                                 f"to {MOST_BYTES} bytes")
        return f"data:{kind};base64," + base64.b64encode(path.read_bytes()).decode("ascii")
    except ParameterError as error:
        notes.append(f"not drawn: {error}")
        return ""
