"""Named arms and arms of one's own: they run alone and under other scenarios, and their files are made from a URDF."""

import pytest
import yaml

import aras_visual_servo as avs
from aras_visual_servo.arm.home import least_singular_value, SINGULAR
from aras_visual_servo.config.files import arm_names, find_scenario
from aras_visual_servo.scenario.new_arm import arm_files, NewArm

#: Flange of each arm.
TIPS = {"gen3": "end_effector_link", "iiwa7": "iiwa_link_ee_kuka", "panda": "panda_link8", "so101": "gripper",
        "ur10e": "tool0", "ur5e": "tool0", "xarm6": "link6"}
ARMS = sorted(TIPS)
#: Runs: each arm alone, and arms under scenarios of another robot, laws with joint limits and a wall among them.
RUNS = [*((name, {}) for name in ARMS), ("experiment_2", {"robot": "so101"}), ("six_dof_qp", {"robot": "panda"}),
        ("six_dof_tag", {"robot": "ur5e"})]


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
