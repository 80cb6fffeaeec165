"""Named arms and arms of one's own: they run alone and under other scenarios, and their files are made from a URDF."""

import numpy as np
import pytest
import yaml

import aras_visual_servo as avs
from aras_visual_servo.arm.home import in_view, least_singular_value, points_of, SINGULAR
from aras_visual_servo.arm.reach import reach
from aras_visual_servo.arm.urdf_check import moved_links
from aras_visual_servo.config.files import arm_names, find_scenario
from aras_visual_servo.scenario.new_arm import arm_files, NewArm

#: Flange of each arm.
TIPS = {"gen3": "end_effector_link", "iiwa7": "iiwa_link_ee_kuka", "panda": "panda_link8", "so101": "gripper",
        "ur10e": "tool0", "ur5e": "tool0", "xarm6": "link6"}
ARMS = sorted(TIPS)
#: Runs: each arm alone, and arms under scenarios of another robot, laws with joint limits and a wall among them.
RUNS = [*((name, {}) for name in ARMS), ("experiment_2", {"robot": "so101"}), ("six_dof_qp", {"robot": "panda"}),
        ("six_dof_points", {"robot": "ur5e"})]


def files_of(name):
    return find_scenario(name).parent


def test_every_arm_has_a_folder():
    assert arm_names() == sorted(ARMS) and set(avs.scenario_names()).isdisjoint(ARMS)


@pytest.mark.parametrize("name, changes", RUNS)
def test_an_arm_runs_alone_and_under_another_scenario(name, changes):
    scenario = avs.load_scenario(name, changes)
    kinematics = scenario.kinematics()
    assert least_singular_value(kinematics, scenario.goal_posture(kinematics)) > 5 * SINGULAR
    judgement = avs.judge(avs.run(scenario))
    assert judgement.passed, (scenario.name, judgement)


@pytest.mark.parametrize("name", ARMS)
def test_the_files_of_an_arm_are_those_that_its_urdf_gives(name):
    there, text = files_of(name), (files_of(name) / "arm.urdf").read_text()
    scenario = yaml.safe_load((there / "scenario.yaml").read_text())
    home = scenario["experiment"]["goal"]["joints"]
    made, controllers = arm_files(NewArm(name, scenario["robot"]["urdf"], scenario["robot"]["controllers"], TIPS[name],
                                         "camera_optical_frame", scenario["experiment"]["z_star_m"],
                                         yaml.safe_load((there / "table.yaml").read_text())["driver"]["controller"],
                                         home), text)
    assert yaml.safe_load(controllers) == yaml.safe_load((there / "controllers.yaml").read_text())
    made = yaml.safe_load(made)
    for place in ("goal", "start"):
        assert made["experiment"].pop(place)["joints"] == pytest.approx(
            scenario["experiment"].pop(place)["joints"], abs=1e-3)
    for document in (made, scenario):
        del document["sim"]  # the target, which stands where the goal sees it
    scenario.pop("sweep", None)
    assert made == scenario


@pytest.mark.parametrize("base, tip", [("six_axis_flange", "wrist_3_link"), ("six_dof_rectangle", "link6")])
def test_a_home_is_found_from_which_the_arm_does_not_hide_the_target(base, tip, tmp_path):
    """The second arm takes efforts: it gets PIDs."""
    text, z_star_m = avs.load_scenario(base).urdf_xml(), 0.45
    made = arm_files(NewArm("mine", "arm.urdf", "controllers.yaml", tip, "camera_optical_frame", z_star_m), text)
    for name, content in zip(("arm.urdf", "scenario.yaml", "controllers.yaml"), (text, *made)):
        (tmp_path / name).write_text(content)
    scenario = avs.load_scenario(tmp_path / "scenario.yaml")
    kinematics = scenario.kinematics()
    goal, names = scenario.goal_posture(kinematics), kinematics.joint_names
    points = points_of(text, scenario.robot["base_link"], moved_links(text, "camera_optical_frame"), names)
    X = kinematics.pose(goal)
    assert not in_view(X, points(goal), z_star_m) and in_view(X, X[:3, 3] + 0.3 * X[:3, 2:].T, z_star_m)
    effort = "EffortJointInterface" in text
    assert all(("pid" in entry) == effort for entry in scenario.controllers().values() if "joint" in entry)
    assert avs.judge(avs.run(scenario)).passed


def test_seven_axes_bring_the_elbow_back():
    """The start has the same camera pose as the arm's own, the elbow swung out by 0.7 rad."""
    scenario = avs.load_scenario("six_dof_points", {"robot": "panda"})
    kinematics = scenario.kinematics()
    goal, q = scenario.goal_posture(kinematics), scenario.start_posture(kinematics)
    X = kinematics.pose(q)
    for _ in range(30):
        spare = np.linalg.svd(kinematics.jacobian(q))[2][-1]
        joints, _ = reach(kinematics, q + 0.024 * spare * np.sign(spare[np.argmax(np.abs(spare))]), X)
        q = kinematics.vector(joints)
    left = {}
    for name, gain in (("off", 0.0), ("on", 2.0)):
        record = avs.run(scenario.with_overrides({
            "experiment.start": {"joints": kinematics.by_name(q)},
            "servo.null_space": {"posture_gain_per_s": gain, "joint_limit_gain_per_s": 0.0,
                                 "manipulability_gain_per_s": 0.05 if gain else 0.0}}))
        assert avs.judge(record).passed
        left[name] = np.linalg.norm(record.q[record.servo_rows][-1] - goal)
    assert left["on"] < 0.1 < 0.5 < left["off"]
