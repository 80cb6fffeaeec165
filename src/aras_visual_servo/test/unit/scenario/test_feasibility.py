"""What is refused before anything moves: joint limits, a target not in view, a wrist that would be wound up."""

from dataclasses import replace

import numpy as np
import pytest

from aras_visual_servo import (
    Feasibility, Kinematics, load_scenario, Outline, ParameterError, reach, scenario_names, ServoLoop)
from aras_visual_servo.cli import EXIT_PARAMETERS
from aras_visual_servo.cli.main import main
from aras_visual_servo.scenario.feasibility import check_feasible, check_workspace

GOAL = {"gantry": 0.0, "J1": 0.0, "J2": -0.5836, "J3": 1.6208, "J5": -1.0372, "J6": 0.0}
#: The image's own outline is found on whole pixels: half a pixel each side, and what settling moves the camera by.
PIXEL_PX = 1.0


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("field_of_view")


def kinematics_of(scenario, wrist=None):
    urdf = scenario.urdf_xml()
    if wrist is not None:
        old = '<joint name="J6" type="continuous">'
        assert old in urdf
        urdf = urdf.replace(old, '<joint name="J6" type="revolute">')
        begin = urdf.index('name="J6"')
        end = urdf.index("</joint>", begin)
        joint = urdf[begin:end].replace("<limit ", f'<limit lower="{-wrist}" upper="{wrist}" ')
        urdf = urdf[:begin] + joint + urdf[end:]
    return Kinematics(urdf, scenario.robot["base_link"], scenario.robot["tip_link"])


@pytest.fixture(scope="module")
def kinematics(scenario):
    return kinematics_of(scenario)


def refusal(scenario, kinematics, goal=None, **start):
    feasibility = Feasibility(scenario, kinematics)
    return feasibility.refusal(kinematics.vector({**GOAL, **(goal or {})}), kinematics.vector({**GOAL, **start}))


def test_a_joint_that_the_goal_does_not_name_stays_where_the_simulator_starts_it(scenario, kinematics):
    joints = {"J2": -0.5836, "J5": -1.0372}
    scenario = replace(scenario, experiment={**scenario.experiment, "goal": {"joints": joints}},
                       sim={**scenario.sim, "initial_positions": {"J3": 1.6208, "J5": 0.3}})
    goal = kinematics.by_name(scenario.goal_posture(kinematics))
    assert goal == {"gantry": 0.0, "J1": 0.0, "J2": -0.5836, "J3": 1.6208, "J5": -1.0372, "J6": 0.0}
    scenario = replace(scenario, experiment={**scenario.experiment, "start": {"joints": {"J5": -1.0}}})
    assert kinematics.by_name(scenario.start_posture(kinematics)) == {**goal, "J5": -1.0}


def test_a_joint_whose_limits_leave_out_zero_starts_at_the_nearer_one(scenario):
    class OneJoint:
        joint_names, lower, upper = ("J2",), np.array([-2.0]), np.array([-0.5])
        by_name = staticmethod(lambda vector: {"J2": float(vector[0])})
        vector = staticmethod(lambda joints: np.array([joints["J2"]]))

    scenario = replace(scenario, sim={}, experiment={"goal": {"joints": {}}})
    assert scenario.goal_posture(OneJoint).tolist() == [-0.5]


def test_what_can_be_run_is_not_refused(scenario, kinematics):
    assert refusal(scenario, kinematics, J6=2.9, gantry=0.1) == ""


@pytest.mark.parametrize("goal, start, expected", [
    ({}, {"J1": 2.2}, "outside joint limits: J1 2.2 not in [-2.094, 2.094]"),
    ({"J3": 2.5, "J2": -2.3}, {}, "goal outside joint limits: J2 -2.3 not in [-2.094, 2.094], J3 2.5 not in"),
    ({}, {"gantry": 0.4}, "target not in view at the start: beyond the image border by"),
    ({"gantry": 0.4}, {}, "target not in view at the goal: beyond the image border by"),
    ({}, {"J5": 2.0}, "target not in view at the start: behind the camera"),
])
def test_a_refusal_names_its_reason(scenario, kinematics, goal, start, expected):
    assert refusal(scenario, kinematics, goal, **start).startswith(expected)


def test_a_limited_wrist_is_not_wound_up(scenario):
    # Home is 0.68 rad on, through the limit; 5.6 rad back is not what a servo does.
    limited = kinematics_of(scenario, wrist=2.97)
    text = refusal(scenario, limited, {"J6": 2.8}, J6=-2.8)
    assert text == ("goal posture outside joint limits after the shorter turn: "
                    "J6 would end at -3.483, not in [-2.97, 2.97]")
    assert refusal(scenario, limited, {"J6": 1.0}, J6=-1.0) == ""
    assert refusal(scenario, kinematics_of(scenario), {"J6": 2.8}, J6=-2.8) == ""


def test_the_outline_is_where_the_camera_sees_it(scenario):
    loop = ServoLoop(scenario)
    outline, compared = Outline.of(scenario), 0
    for start in ({"J6": 0.9, "gantry": 0.1}, {"J5": -0.9, "J1": 0.3}):
        loop.place({**GOAL, **start}, 0.3)
        loop.sim.step_to_image("camera")
        image = np.asarray(loop.sim.render("camera")).min(axis=2)
        rows, columns = np.nonzero(image < 125)
        pixels = outline.pixels(loop.sim.camera_pose("camera"))
        found = np.array([columns.min(), rows.min(), columns.max(), rows.max()])
        np.testing.assert_allclose(np.concatenate([pixels.min(axis=0), pixels.max(axis=0)]), found, atol=PIXEL_PX)
        border = min(found[0], found[1], 319 - found[2], 239 - found[3])
        assert outline.border_px(loop.sim.camera_pose("camera")) == pytest.approx(border + 0.5, abs=PIXEL_PX)
        compared += 1
    assert compared == 2


def test_a_posture_reached_is_where_it_was_asked_for(kinematics):
    near = kinematics.vector(GOAL)
    X = kinematics.pose(near)
    X[:3, 3] += [0.02, -0.1, 0.05]
    joints, reason = reach(kinematics, near, X)
    assert reason == ""
    np.testing.assert_allclose(kinematics.pose(kinematics.vector(joints)), X, atol=1e-3)


@pytest.mark.parametrize("override, expected", [
    ("experiment.start.joints.gantry=0.4", "target not in view at the start: beyond the image border by"),
    ("experiment.goal.joints.J3=2.5", "goal outside joint limits: J3 2.5 not in [-2.094, 2.094]"),
])
def test_a_run_that_cannot_be_done_is_refused_before_anything_moves(tmp_path, capsys, override, expected):
    words = ["field_of_view", "--output", str(tmp_path), "--set", override]
    assert main(["run", *words]) == EXIT_PARAMETERS
    assert f"scenario 'field_of_view' refused, nothing has moved: {expected}" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", scenario_names())
def test_the_scenarios_that_come_along_can_be_run(name):
    check_feasible(load_scenario(name))


def test_keypoints_need_no_more_than_a_part_of_the_target_in_view():
    large = load_scenario("cns_render")
    assert large.servo["source"] == "matches"
    check_feasible(large)
    whole = load_scenario("cns_render", {"servo.source": "tag", "vision.tag": {"family": "36h11", "id": 0}})
    with pytest.raises(ParameterError, match="target not in view at the goal"):
        check_feasible(whole)


def test_a_workspace_without_the_camera_at_goal_or_start_is_named(scenario, kinematics, capsys):
    ends = {"goal": scenario.goal_posture(kinematics), "start": scenario.start_posture(kinematics)}
    places = np.array([kinematics.pose(joints)[:3, 3] for joints in ends.values()])

    def checked(lower, upper):
        check_workspace(scenario.with_overrides({
            "real.workspace": {"lower_m": lower.tolist(), "upper_m": upper.tolist()}}))
    check_workspace(scenario)
    checked(places.min(axis=0) - 0.01, places.max(axis=0) + 0.01)
    axis = int(np.argmax(np.abs(places[0] - places[1])))
    for i, name in enumerate(ends):
        room = np.full(3, 1.0)
        room[axis] = 0.5 * abs(places[0] - places[1])[axis]
        with pytest.raises(ParameterError) as error:
            checked(places[1 - i] - room, places[1 - i] + room)
        (fault,) = error.value.faults
        assert fault.startswith("real.workspace: ") and f"at the {name} " in fault
    change = "real.workspace={lower_m: [5, 5, 5], upper_m: [6, 6, 6]}"
    assert main(["scenario", "check", "field_of_view", "--set", change]) == EXIT_PARAMETERS
    assert capsys.readouterr().out.count("real.workspace: ") == 2
