"""Where the arm's reach ends, its elbow is stretched and goes to and fro: the status says so (docs/comparison.md)."""
import pytest

from aras_visual_servo_controller.arm.reach import reach
from aras_visual_servo_controller.arm.robot import robot_kinematics
from aras_visual_servo_controller.compare.laws import load_comparison
from aras_visual_servo_controller.ground.types import Status
from aras_visual_servo_controller.sweep.plan import Start
from aras_visual_servo_controller.sweep.run import Bench

#: How near to the lowest place of a run [mm], and of how many images there at least, in ten, the status is asked for.
NEAR_MM, LEAST_OF_TEN = 8, 9


@pytest.mark.parametrize("task", ["turn_90", "turn_135"])
def test_where_the_reach_ends_the_status_says_so(task):
    comparison = load_comparison("canonical", ["points_goal"], [task])
    scenario = comparison.scenarios["points_goal"]
    kinematics = robot_kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    goal = scenario.goal_posture(kinematics)
    joints, refusal = reach(kinematics, goal, kinematics.pose(goal) @ comparison.tasks[0].X_CgC)
    assert not refusal, refusal
    _, record = Bench(scenario).run(Start(1, joints))
    height_mm = 1e3 * record.X_WC[record.servo_rows, 2, 3]
    status = record.status[record.servo_rows][height_mm < height_mm.min() + NEAR_MM]
    assert len(status) > 100, "the arm does not stay at its lowest place"
    assert (status == Status.NEAR_SINGULARITY).mean() >= 0.1 * LEAST_OF_TEN
