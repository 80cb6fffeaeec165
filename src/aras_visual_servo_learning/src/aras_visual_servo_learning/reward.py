"""What a step of an environment is worth."""

from typing import Any, Dict, Optional

import numpy as np

from aras_visual_servo import (FeatureSet, ParameterError, RobotKinematics, Scenario, Servo, View, simulation_of,
                               source_named)

#: One radian away costs as much as this distance [m]: about that of the target in the shipped scenarios.
LENGTH_M = 0.5
#: What the last step is worth that arrives.
ARRIVED = 1.0


class PoseReward:
    """Minus the true distance from the goal [m], an angle counted as LENGTH_M for each radian; ARRIVED on success."""

    wants_image = False

    def __init__(self, scenario: Scenario, kinematics: RobotKinematics) -> None:
        pass

    def teach(self, image: Optional[np.ndarray], stamp_ns: int, q: np.ndarray) -> None:
        """The view at the goal."""

    def __call__(self, info: Dict[str, Any], image: Optional[np.ndarray], stamp_ns: int) -> float:
        return ARRIVED * info["is_success"] - info["distance_m"] - LENGTH_M * info["angle_rad"]


class FeatureReward:
    """Minus the errors of the scenario's features, each in parts of 1000 of its thresholds; ARRIVED on success. A view
    without the target is worth what the worst view so far was worth. info gets `feature_error` and `target_visible`."""

    wants_image = True
    PART = 1000.0

    def __init__(self, scenario: Scenario, kinematics: RobotKinematics) -> None:
        self._scenario, self._servo, self._worst = scenario, Servo(kinematics, scenario.servo), 1.0
        self._features = FeatureSet(self._servo.config.features, self._servo.config.settings)
        self._scale = 1.0 / (self.PART * np.array(self._servo.config.thresholds))
        self._z_star_m = scenario.experiment["z_star_m"]
        self._info = self._camera_info(scenario)
        self._source = source_named(self._features.source)
        if self._source.wants_depth(scenario.vision):
            raise ParameterError("vision.depth: found with a reward by features, allowed without it: rewards see "
                                 "images alone")

    @staticmethod
    def _camera_info(scenario):
        sim = simulation_of(scenario)
        return scenario.believed_camera_info(sim.camera_info(scenario.sim["cameras"][0]["name"]))

    def teach(self, image: Optional[np.ndarray], stamp_ns: int, q: np.ndarray) -> None:
        """The view at the goal: the features are relative to it from now on."""
        self._extractor = self._source.extractor(self._info, self._scenario.vision)
        features = self._extractor.process(image, stamp_ns)
        reference = self._servo.teach(features, q, self._z_star_m)
        self._extractor.teach(stamp_ns, self._z_star_m)
        self._s_star, self._worst = reference.s_star, 1.0

    def __call__(self, info: Dict[str, Any], image: Optional[np.ndarray], stamp_ns: int) -> float:
        features = self._extractor.process(image, stamp_ns)
        lost = self._servo.why_lost(features)
        info["target_visible"] = not lost
        if not lost:
            s = np.array(self._features.values(View(features)))
            e = np.array(self._features.error(s, self._s_star, self._servo.config.symmetric_target))
            info["feature_error"] = e
            cost = float(np.abs(e * self._scale).mean())
            self._worst = max(self._worst, cost)
        return ARRIVED * info["is_success"] - (self._worst if lost else cost)


REWARDS: Dict[str, Any] = {"pose": PoseReward, "features": FeatureReward}
