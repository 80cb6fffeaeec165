"""Settings of an experiment: the scenario's section `experiment`."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Dict, Optional

from ..config.reader import Names, read
from ..config.settings import setting


@dataclass(frozen=True)
class Place:
    """Where the arm stands."""

    joints: Dict[str, float] = setting(
        unit="m, rad", by="joint_position", not_empty=True,
        help="Positions by the names of the joints, within their limits; a joint that is not named stays where it is.")


@dataclass(frozen=True)
class JudgeSettings:
    """Section `experiment.judge`: the largest final error of the true camera pose, in the goal camera's frame."""

    x_mm: float = setting(unit="mm", above=0, help="Along x of the goal camera.")
    y_mm: float = setting(unit="mm", above=0, help="Along y of the goal camera.")
    z_mm: float = setting(unit="mm", above=0, help="Along z of the goal camera.")
    angle_deg: float = setting(unit="deg", above=0, help="Angle of the rotation that is left.")


@dataclass(frozen=True)
class ExperimentSettings:
    """Section `experiment`: teach the view at the goal, go to the start, servo, judge."""

    goal: Place = setting(help="Where the view is taught that the servo is to find again.")
    start: Place = setting(help="Where the servo starts.")
    z_star_m: float = setting(unit="m", above=0, help="Depth of the target in the taught view.")
    settle_s: float = setting(0.5, unit="s", at_least=0, help="The arm waits at least this long at goal and start.")
    settle_limit_s: float = setting(
        2.0, unit="s", above=0,
        help="It waits at most this much longer for its joints to rest.")
    settle_speed: float = setting(0.002, unit="m/s, rad/s", above=0, help="A joint slower than this is at rest.")
    speed_part: float = setting(
        0.3, above=0, at_most=1,
        help="Part of the joints' velocity limits that the trajectories to goal and start use.")
    acceleration: float = setting(2.0, unit="m/s^2, rad/s^2", above=0, help="Acceleration on these trajectories.")
    image_period_s: float = setting(
        1.0 / 30.0, unit="s", above=0,
        help="Time between two images, taken for the first one only; it is measured afterwards.")
    judge: Optional[JudgeSettings] = setting(
        None,
        help="A run passes when its final error is within these; without, when it has converged.")

    @classmethod
    def from_dict(cls, source, kinematics):
        """Read the section, but for `judge`, which is not the arm's. Raises ParameterError listing every fault."""
        limits = {name: (float(lower), float(upper)) for name, lower, upper
                  in zip(kinematics.joint_names, kinematics.lower, kinematics.upper)}
        if isinstance(source, Mapping):
            source = {key: value for key, value in source.items() if key != "judge"}
        return read(cls, source, "experiment", Names(joints=tuple(limits), limits=limits))
