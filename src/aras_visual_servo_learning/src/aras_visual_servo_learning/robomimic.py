"""Runs as an HDF5 file in robomimic's layout.

    data            attributes total (rows of all demonstrations) and env_args (JSON: env_name, type, env_kwargs)
    data/demo_0     attributes num_samples, run, scenario (YAML); obs/NAME, next_obs/NAME, actions, rewards, dones,
                    states
    mask/train      names of demonstrations; mask/valid likewise

See https://robomimic.github.io/docs/datasets/overview.html. Of each image the state is q and the pose of the camera.
"""

import json
from pathlib import Path
from typing import Any, Dict, Iterable, Optional, Tuple, Union

import numpy as np
import yaml

from aras_visual_servo import ParameterError, RunRecord, Status, extra, goal_pose, spatial

from .reward import ARRIVED, LENGTH_M

#: Every so many demonstrations one is for validation.
VALID_EVERY = 10
#: Type of environment: robomimic's own number of a gym environment.
GYM_TYPE = 2


def write_hdf5(path: Union[str, Path], records: Iterable[Tuple[str, RunRecord]], images: bool = False,
               fully_converged: bool = False) -> int:
    """Write runs. Returns the number of demonstrations.

    Args:
        records: (name, RunRecord) one after the other.  images: with the images of the servo phase.
        fully_converged: leave out runs that did not converge.
    Raises: MissingExtra: there is no h5py.  ParameterError: there is nothing to write.
    """
    h5py = extra("h5py", "writing HDF5")
    total, names = 0, []
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        for name, record in records:
            demo = demonstration(record, images)
            if demo is None or fully_converged and not demo["rewards"][-1] > 0.5:
                continue
            group = data.create_group(f"demo_{len(names)}")
            names.append(f"demo_{len(names)}")
            n = len(demo["actions"])
            group.attrs["num_samples"], group.attrs["run"] = n, name
            group.attrs["scenario"] = yaml.safe_dump(record.settings, sort_keys=False)
            for part in ("obs", "next_obs"):
                for key, values in demo[part].items():
                    group.create_dataset(f"{part}/{key}", data=values, **(
                        {"compression": "gzip", "chunks": (1, *values.shape[1:])} if key == "image" else {}))
            for key in ("actions", "rewards", "dones"):
                group.create_dataset(key, data=demo[key])
            obs = demo["obs"]
            group.create_dataset("states", data=np.hstack((obs["joint_positions"], obs["camera_pose"])))
            total += n
        if not names:
            raise ParameterError("export: no run has two images of a servo phase, there is nothing to write")
        data.attrs["total"] = total
        data.attrs["env_args"] = json.dumps({
            "env_name": "aras_visual_servo_learning:ArasServo-State-v0", "type": GYM_TYPE,
            "env_kwargs": {"scenario": record.scenario, "action": "twist"}})
        valid = names[VALID_EVERY - 1::VALID_EVERY] or names[-1:]
        for mask, chosen in (("valid", valid), ("train", [name for name in names if name not in valid] or names)):
            file.create_dataset(f"mask/{mask}", data=np.array(chosen, dtype="S"))
    return len(names)


def demonstration(record: RunRecord, images: bool = False) -> Optional[Dict[str, Any]]:
    """One run as a demonstration: arrays of its servo phase, n rows, one per image but the last.

    Returns:
        dict: `obs` and `next_obs`, each a dict of joint_positions (n, m), camera_pose (n, 6) in the frame of the goal
        camera (position [m], rotation vector [rad]), features (n, k), feature_errors (n, k) and, with images, image
        (n, h, w, 3) uint8; `actions` (n, 6), the twist V_C [v; w] that was commanded; `rewards` (n,), those of
        `PoseReward`; `dones` (n,), 1 in the last row. None if the servo phase has fewer than two images.
    """
    rows = record.servo_rows
    if images:
        rows = np.array([row for row in rows if row in record.images], dtype=int)
    if len(rows) < 2:
        return None
    poses = np.array([_pose(np.linalg.solve(goal_pose(record, row), record.X_WC[row])) for row in rows])
    seen = {"joint_positions": record.q[rows], "camera_pose": poses, "features": record.s[rows],
            "feature_errors": record.e[rows]}
    if images:
        seen["image"] = np.array([record.images[row] for row in rows])
    arrived = record.status[rows[-1]] == Status.CONVERGED
    rewards = -np.linalg.norm(poses[1:, :3], axis=1) - LENGTH_M * np.linalg.norm(poses[1:, 3:], axis=1)
    rewards[-1] += ARRIVED * arrived
    dones = np.zeros(len(rows) - 1, dtype=np.int64)
    dones[-1] = 1
    return {"obs": {name: values[:-1] for name, values in seen.items()},
            "next_obs": {name: values[1:] for name, values in seen.items()},
            "actions": np.nan_to_num(record.twist[rows][:-1]), "rewards": rewards, "dones": dones}


def _pose(X):
    return np.concatenate((X[:3, 3], spatial.rotation_vector(X[:3, :3])))
