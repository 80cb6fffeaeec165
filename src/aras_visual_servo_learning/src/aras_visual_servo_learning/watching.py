"""The arm of an environment from beside."""

from typing import Sequence

import numpy as np

from aras_visual_servo_study.report.observer import Observer
from aras_visual_servo import RecordBuilder, Scenario


class Watcher:
    """Pictures of the arm at any joint positions. Args: at_C: (3,) where the camera is at the goal [m]."""

    def __init__(self, scenario: Scenario, at_C: np.ndarray, joint_names: Sequence[str], width: int = 480,
                 height: int = 360):
        builder = RecordBuilder(scenario.name, joint_names, settings=scenario.as_dict())
        X_WC = np.eye(4)
        X_WC[:3, 3] = at_C
        builder.add_row(0, "servo", X_WC=X_WC)
        models = scenario.sim.get("scene", {}).get("models", [])
        X_WT = np.eye(4)
        X_WT[:3, 3] = models[0].get("position_m", [0.0, 0.0, 0.0]) if models else [at_C[0], at_C[1], 0.0]
        self._observer = Observer(builder.finish(X_WT=X_WT), width, height)

    def picture(self, q: np.ndarray) -> np.ndarray:
        """uint8 (height, width, 3), the caller's own, with the joints at q, (n,)."""
        return self._observer.picture(q)
