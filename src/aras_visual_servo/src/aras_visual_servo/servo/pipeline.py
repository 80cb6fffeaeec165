"""The stages of the servo, in the order in which an image passes through them."""

from typing import Any, List, Optional, Tuple

import numpy as np

from ..arm.motion import ArmMotion
from ..laws.base import make_law
from .arrival import Arrival
from .feature_filter import FeatureFilter
from .feed_forward import TargetMotion
from .gates import Hindrance, Stale, TimeLimit
from .goal import Goal
from .look_then_move import LookThenMove, UnderWay
from .lost_target import AfterLoss, LostTarget
from .nearest_point import NearestPoint
from .out_of_reach import OutOfReach
from .settings import ServoSettings
from .stage import STAGES, SixNumbers, Stage
from .stages import Calm, CreepCompensation, JointPlace, JointVelocity, LawStage, SmoothStart, Tilt
from .visibility import Visibility


def make_stages(goal: Goal, arm: ArmMotion, config: ServoSettings, start_ns: int,
                set_point: Optional[np.ndarray] = None) -> Tuple[List[Stage], LostTarget, Hindrance]:
    """Returns new stages without history, the one that recovers a lost target, and the tracker of standstills.

    Args: start_ns: start of the time limit.  set_point: (n,) joint set-points commanded last, None: as measured.
    Raises ParameterError.
    """
    law, hindrance, kinematics = make_law(config.law, config.gains_per_s, config), Hindrance(), goal.kinematics
    tracker: Any = config.filter and FeatureFilter(config.filter, goal.features, config.symmetric_target)
    lost = LostTarget(kinematics, arm, config.on_lost, config.lost_target, goal.source, tracker)
    arrival = Arrival(goal, arm, config, tracker)
    swings = law.moves_joints or bool(config.limits.joint_acceleration)
    moves = LookThenMove(kinematics, arm, config, arrival, set_point)
    nearest: Any = config.out_of_reach and NearestPoint(config.out_of_reach, goal, arm, config)
    looks, calms = config.mode == "look_then_move", config.creep_rate_per_s > 0.0 and not config.follows
    gates: List[Any] = [
        TimeLimit(config, start_ns, arrival, hindrance),
        Stale(len(kinematics.joint_names), config.input_timeout_s, tracker),
        looks and UnderWay(moves),
        lost,
    ]
    twist: List[Any] = [
        LawStage(law, goal, tracker, not looks),
        config.smooth_start_per_s > 0.0 and SmoothStart(config.smooth_start_per_s),
        config.on_lost != "hold" and AfterLoss(lost),
        arrival,
    ]
    last: List[Any] = [moves] if looks else [
        calms and Calm(arrival.rule, config.tilt_gain_per_s),
        config.feed_forward and TargetMotion(config.feed_forward, goal.features, tracker),
        JointPlace(arm),
        arrival.holds_tilt and Tilt(arm, config.tilt_gain_per_s),
        config.visibility and Visibility(config.visibility),
        calms and CreepCompensation(config.creep_rate_per_s, arrival.rule),
        *(stage for name in config.stages for stage in (STAGES[name](kinematics, config), SixNumbers(name))),
        JointVelocity(arm, law, tracker, OutOfReach(arm, arrival.rule, swings, nearest)),
    ]
    return list(filter(None, gates + twist + last)), lost, hindrance
