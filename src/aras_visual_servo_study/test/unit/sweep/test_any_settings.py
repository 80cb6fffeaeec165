"""Whatever stands in the section `sweep`, runs are planned from it or it is refused with the faults."""
import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import (
    ArasError, BALL_AXES, CAMERA_AXES, GOAL_AXES, keys_of, Kinematics, load_scenario, ParameterError, Perturbations,
    scenario_from_dict, SweepSection)
from aras_visual_servo.scenario.sweep import METHODS, SPACES, ViewRanges
from aras_visual_servo_study.sweep.perturb import perturbed
from aras_visual_servo_study.sweep.plan import make_starts, SweepSettings

SCENARIO = load_scenario("experiment_1")
KINEMATICS = Kinematics(SCENARIO.urdf_xml(), SCENARIO.robot["base_link"], SCENARIO.robot["tip_link"])
FEW = st.integers(1, 3)  # starts; what many do is a question of time
NUMBERS = st.floats() | st.sampled_from([0, -1, 3, 10**400, 2**63, 1e308, -1e308, 5e-324, 0.1, -0.1, 1.0])
ODD = st.sampled_from([None, True, "", "x", [], {}, [[]], {"values": []}, {"values": [None]}, {1: 2}, "9" * 300])
RANGES = st.lists(NUMBERS, min_size=2, max_size=2).map(sorted) | st.lists(NUMBERS, max_size=3) | NUMBERS | ODD
PATHS = ("servo.gains_per_s.xn", "experiment.z_star_m", "sim.cameras", "vision.threshold", "servo.law", "time.lockstep",
         "experiment.start.joints.J1", "servo.no_such_key", "servo.gains_per_s", "..", "", "sim.period_s")


def ranges_of(names):
    return st.dictionaries(st.sampled_from(names), RANGES, max_size=3) | ODD


SECTION = st.fixed_dictionaries({"starts": FEW}, optional={
    "method": st.sampled_from(METHODS) | ODD, "space": st.sampled_from(SPACES) | ODD, "seed": NUMBERS | st.integers(),
    "drive_to_start": st.booleans() | ODD, "abort_factor": NUMBERS | ODD, "camera": ranges_of(CAMERA_AXES),
    "ball": ranges_of(BALL_AXES), "view": ranges_of([key.name for key in keys_of(ViewRanges)]),
    "joints": ranges_of([*KINEMATICS.joint_names, "nobody"]), "goal": ranges_of(GOAL_AXES),
    "perturb": st.dictionaries(st.sampled_from([*(key.name for key in keys_of(Perturbations)), *PATHS]),
                               RANGES | st.fixed_dictionaries({"values": st.lists(NUMBERS | ODD, max_size=2)}),
                               max_size=2) | ODD})


def plan(section):
    """The starts planned, or None if the section is refused."""
    try:
        scenario = scenario_from_dict(dict(SCENARIO.as_dict(), sweep=section), base=SCENARIO._base)
        starts = make_starts(SweepSettings.from_scenario(scenario, KINEMATICS), scenario, KINEMATICS)
        for start in starts:
            perturbed(scenario, start.parameters)
        return starts
    except ArasError as error:
        assert str(error)
        return None


@settings(deadline=None, max_examples=150, derandomize=True)
@given(SECTION)
def test_any_section_is_planned_or_refused(section):
    starts = plan(section)
    assert starts is None or 1 <= len(starts) <= section["starts"]


def test_the_keys_drawn_are_those_there_are():
    assert {key.name for key in keys_of(SweepSection)} == {
        "starts", "method", "space", "seed", "drive_to_start", "abort_factor", "camera", "ball", "view", "joints",
        "goal", "perturb"}


@pytest.mark.parametrize("starts", [10**8, 10**400], ids=["10^8", "10^400"])
def test_more_starts_than_anybody_runs_are_refused(starts):
    with pytest.raises(ParameterError, match=r"sweep.starts: found 10+(\.\.\.)?, allowed .*<= 1000000"):
        SweepSettings.from_scenario(SCENARIO, KINEMATICS, starts=starts)
