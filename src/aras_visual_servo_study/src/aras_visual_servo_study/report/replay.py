"""The replay of a report: the run in the 3-D view of the live page, with a slider of time. All of it is in the page.

Joints, camera and target are those of the record. Where the record holds no images of the servo phase, they are drawn
again from the recorded joint positions: the same pixels as in the run, but for noise.
"""

import base64
import json
import math
import re
from typing import Any, Dict

import numpy as np

from aras_visual_servo import (ArasError, ParameterError, RunRecord, goal_pose, in_rgb, kinematics_of,
                               scenario_from_dict, simulation_of, spatial)
from ..files import THREE_FILES, three_file
from ..live.hub import jpeg
from ..live.view.projection import middle
from ..live.view.robot import mesh_blocks, robot_of
from ..live.view.scene import drawn, pose_numbers
from .template import script

#: Moments that the slider has at most, images at most and at least, and their size together [bytes].
MOST_MOMENTS, MOST_IMAGES, LEAST_IMAGES, IMAGE_BYTES = 400, 90, 10, 500_000
#: The page's own modules, each after those that it imports.
MODULES = ("lib/meshes.js", "lib/units.js", "lib/robot.js", "lib/props.js", "lib/world.js", "replay.js")


class ReplayError(ArasError):
    """The run cannot be shown again. The text says what is missing."""


def replay_of(record: RunRecord) -> Dict[str, Any]:
    """What the page needs for the replay: dict of data (JSON) and scripts (list of texts).

    Raises: ReplayError.
    """
    if not record.settings or not record.camera_info or not len(record.servo_rows):
        raise ReplayError("the record lacks its scenario, its camera or a servo phase")
    try:
        data = _data(record)
        scripts = [three_file(name).read_text(encoding="utf-8") for name in THREE_FILES] + [script(*MODULES)]
    except (RuntimeError, OSError) as error:  # the simulator's errors and ours
        raise ReplayError(f"the run cannot be replayed: {error}") from error
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return {"data": text.replace("<", "\\u003c"), "scripts": [_closed(one) for one in scripts]}


def _closed(text):
    """A script that cannot end its element early."""
    return re.sub(r"</(?=script)", r"<\\/", text, flags=re.IGNORECASE)


def _data(record):
    scenario = scenario_from_dict(record.settings)
    urdf, rows = scenario.urdf_xml(), record.servo_rows
    kinematics = kinematics_of(urdf, scenario.robot, calibrated=False)
    rows = rows[np.isfinite(record.q[rows]).all(axis=1)]
    if not len(rows):
        raise ParameterError("no row of the servo phase has joint positions")
    order = [record.joint_names.index(name) for name in kinematics.joint_names]
    first_ns, chosen = record.stamp_ns[record.servo_rows[0]], _spread(rows, MOST_MOMENTS)
    at_C = middle(record.X_WC[rows, :3, 3])
    models = scenario.sim.get("scene", {}).get("models", [])
    target = models[0]["name"] if models else None
    blocks, notes = mesh_blocks(robot_of(urdf))
    images, again = _images(record, scenario, rows, target)
    moments = [{"t": round(float(record.stamp_ns[row] - first_ns) * 1e-9, 4),
                "q": [round(float(x), 6) for x in record.q[row][order]], "camera": _pose(record.X_WC[row]),
                "target": None if record.target_poses is None else _pose(record.target_poses[row])} for row in chosen]
    try:
        goal = _pose(goal_pose(record, record.servo_rows[-1]))
    except IndexError:  # nothing was taught
        goal = None
    return {"about": drawn(scenario, kinematics, record.camera_info, at_C, record.X_WT, target), "moments": moments,
            "meshes": {name: _base64(block) for name, block in blocks.items()}, "goal": goal, "notes": notes,
            "images": [{"t": round(float(record.stamp_ns[row] - first_ns) * 1e-9, 4), "jpeg": _base64(one)}
                       for row, one in images], "again": again}


def _pose(X):
    return pose_numbers(X) if X is not None and np.isfinite(X).all() else None


def _base64(content):
    return base64.b64encode(content).decode("ascii")


def _spread(rows, most):
    """At most so many of the rows, evenly, with the first and the last."""
    count = min(most, len(rows))
    return rows[np.unique(np.round(np.linspace(0, len(rows) - 1, count)).astype(int))]


def _images(record, scenario, rows, target):
    """([(row, JPEG)], whether they were drawn again)."""
    seen = np.array([row for row in rows if row in record.images], dtype=int)
    again = not len(seen)
    look = _camera(record, scenario, target) if again else record.images.__getitem__
    rows = rows if again else seen

    def encoded(row):
        return jpeg(look(row))

    most = max(LEAST_IMAGES, min(MOST_IMAGES, IMAGE_BYTES // len(encoded(rows[0]))))
    return [(row, encoded(row)) for row in _spread(rows, int(most))], again


def _camera(record, scenario, target):
    """A function that draws the camera's image at a row of the record, grey or rgb, valid until the next."""
    sim = simulation_of(scenario)
    camera = sim.camera_names[0]

    def image(row):
        sim.set_joint_positions({name: float(x) for name, x in zip(record.joint_names, record.q[row])
                                 if math.isfinite(x)})
        X_WT = None if record.target_poses is None else record.target_poses[row]
        if X_WT is not None and np.isfinite(X_WT).all():
            sim.set_model_pose(target, X_WT[:3, 3], spatial.quaternion_xyzw(X_WT[:3, :3]))
        return in_rgb(sim.render(camera), sim.camera_encoding(camera))

    return image
