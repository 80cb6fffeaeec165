"""Options of the servo in pairs: each pair arrives by the true camera pose, or is rejected by name before a motion."""

import itertools

import pytest

import aras_visual_servo as avs

#: On the base of each suite: dotted key of a scenario -> value. `latency` is that of the camera and of the filter.
OPTIONS = {
    "filter": {"servo.filter.noise": 0.001},
    "latency": {"servo.filter.latency_s": 0.066667, "servo.input_timeout_s": 0.5},
    "feed_forward": {"servo.feed_forward.part": 1.0},
    "smooth_start": {"servo.smooth_start_per_s": 5.0},
    "adaptive_gain": {"servo.adaptive_gain": {"infinity_part": 0.4, "slope": 15.0}},
    "camera_limits": {"servo.limits.camera_speed_m_s": 0.15, "servo.limits.camera_turn_rad_s": 0.3},
    "acceleration": {"servo.limits.joint_acceleration": 3.0},
    "creep": {"servo.creep_rate_per_s": 5.0},
    "visibility": {"servo.visibility": {"half_width": 0.85, "half_height": 0.64}},
    "look_then_move": {"servo.mode": "look_then_move", "servo.gains_per_s": 60.0},
    "symmetric_target": {"servo.symmetric_target": True},
    "saturate": {"servo.inverse.at_limits": "saturate"},
    "back_off": {"servo.on_lost": "back_off"},
    "track": {"servo.track": True, "servo.time_limit_s": 6.0},
}
#: Scenario -> (options that it is run without, because it has them or none of what they are about; options at a time).
#: The scenarios stand for options too: points that see the tilt, a law that moves the joints, a target that moves and
#: is followed with feed-forward, and eye-to-hand.
BASES = {"experiment_1": ((), 2), "six_dof_points": (("symmetric_target",), 2),
         "six_dof_qp": (("symmetric_target",), 1), "moving_target": (("feed_forward", "track"), 1),
         "eye_to_hand": ((), 1)}
#: What is refused, by the key that the refusal names.
REFUSED = {**{frozenset(("look_then_move", other)): key for other, key in (
    ("filter", "filter"), ("latency", "filter"), ("feed_forward", "feed_forward"), ("camera_limits", "limits"),
    ("acceleration", "limits"), ("visibility", "visibility"), ("track", "track"),
    ("six_dof_qp", "mode"), ("moving_target", "feed_forward"))},
    frozenset(("eye_to_hand", "feed_forward")): "feed_forward"}
LATE_S = 0.066667


def settings(base, names):
    """Overrides of the base for these options."""
    scenario, given = avs.load_scenario(base), {}
    joints = scenario.kinematics().joint_names
    for name in names:
        given.update(OPTIONS[name])
    for key, by in (("servo.limits.joint_acceleration", joints), ("servo.gains_per_s", scenario.servo["gains_per_s"])):
        if key in given:
            given[key] = dict.fromkeys(by, given[key])
    if "latency" in names:
        given["sim.cameras"] = [{**camera, "latency_s": LATE_S} for camera in scenario.sim["cameras"]]
    if base == "eye_to_hand" and "track" in names:  # only the images of hold_s tell where a followed target is
        given["servo.stop.position_m"] = 0.0003
    return given


def cases():
    for base, (without, count) in BASES.items():
        names = [name for name in OPTIONS if name not in without]
        yield from ((base, together) for together in itertools.combinations(names, count))


@pytest.mark.parametrize("base, names", list(cases()),
                         ids=lambda value: value if isinstance(value, str) else "+".join(value))
def test_options_are_right_together_or_refused_by_name(base, names):
    both = [frozenset(two) for two in itertools.combinations((base, *names), 2)]
    keys = [REFUSED[two] for two in both if two in REFUSED]
    if keys:
        with pytest.raises(avs.ParameterError, match=rf"servo\.{keys[0]}\b"):
            avs.load_scenario(base, settings(base, names))
        return
    record = avs.ServoLoop(avs.load_scenario(base, settings(base, names))).run(closing_s=0.0)
    judgement = avs.judge(record)
    assert judgement.passed, judgement.faults
