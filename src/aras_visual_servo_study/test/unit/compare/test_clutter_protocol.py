"""Protocol `clutter`: what stands in the way is that of its seed, comes after teaching, and is there for one run."""

import numpy as np
import pytest

from aras_visual_servo import load_yaml, ParameterError
from aras_visual_servo_study.compare.protocols import board as boards, clutter, protocol_named


def test_each_condition_brings_what_it_says():
    def made(condition, seed=5):
        return clutter.clutter(condition, np.random.default_rng(seed))

    assert made("plain") == {"solids": [], "lights": []}
    assert len(made("distractors")["solids"]) == clutter.DISTRACTORS
    assert all("motion" in solid for solid in made("shadows")["solids"])
    assert {light["name"] for light in made("light")["lights"]} == {"lamp", "wanderer"}
    everything = [solid["name"] for solid in made("all")["solids"]]
    assert {"distractor_1", "cover", "passer_1", "carrier"} <= set(everything)
    assert len(set(everything)) == len(everything)
    assert str(made("all")) == str(made("all")) != str(made("all", 6))
    for seed in range(20):
        cover, = made("covered", seed)["solids"]
        x, y, _ = cover["box_m"]
        assert x * y == pytest.approx(clutter.COVERED * 0.8 * 0.6)
        assert abs(cover["position_m"][0]) + 0.5 * x == pytest.approx(0.3)  # within the board
        assert abs(cover["position_m"][1]) + 0.5 * y == pytest.approx(0.4)


def test_the_board_is_a_mesh_with_a_picture(tmp_path):
    path = boards.save_mesh(tmp_path / "one", lambda: np.full((6, 8, 3), 90, np.uint8), [0.8, 0.6])
    text = path.read_text()
    assert "v -0.4 -0.3 0" in text and "mtllib one.mtl" in text and boards.load(tmp_path / "one.png").shape == (6, 8, 3)
    again = boards.save_mesh(tmp_path / "one", lambda: pytest.fail("drawn again"), [0.8, 0.6])
    assert again == path


def test_cases_share_starts_and_have_a_file_for_each_start(tmp_path):
    cases = protocol_named("clutter").cases(tmp_path, 2)
    assert len(cases) == len(clutter.SCHEMES) * len(clutter.CONDITIONS)
    assert len({str([(start.id, start.joints) for start in case.starts]) for case in cases}) == 1
    plain, covered = (next(case for case in cases if case.name == f"orb_{name}") for name in ("plain", "covered"))
    assert plain.starts[1].parameters == {}
    assert load_yaml(covered.starts[1].parameters["clutter"])["solids"][0]["name"] == "cover"
    with pytest.raises(ParameterError, match="--board: found nowhere.png"):
        protocol_named("clutter").cases(tmp_path / "other", 1, "nowhere.png")


def test_clutter_comes_after_teaching_and_leaves_with_the_run(tmp_path):
    pytest.importorskip("aras_visual_servo_sim")
    from aras_visual_servo.runs.loop import ServoLoop
    from aras_visual_servo_study.sweep.perturb import put_clutter
    cases = {case.name: case for case in protocol_named("clutter").cases(tmp_path, 1)}
    scenario = cases["orb_all"].scenario
    loop = ServoLoop(scenario)

    def image():
        loop.sim.step_to_image("camera")
        return loop.sim.frame("camera").image.astype(int).mean(axis=2)

    loop.place(loop.sequence.config.goal.joints, 0.1)
    before = image()
    for condition, changed in (("covered", (0.3, 0.7)), ("light", (0.2, 1.0)), ("shadows", (0.005, 0.5))):
        loop.sim.reset()
        loop.place(loop.sequence.config.goal.joints, 0.1)
        put_clutter(loop.sim, scenario, cases[f"orb_{condition}"].starts[0].parameters["clutter"])
        images = [image() for _ in range(12)]
        part = max((np.abs(one - before) > 8).mean() for one in images)
        assert changed[0] < part <= changed[1], (condition, part)
        moves = np.abs(images[-1] - images[0]).max() > 8
        assert moves == (condition != "covered")
    loop.sim.reset()
    loop.place(loop.sequence.config.goal.joints, 0.1)
    np.testing.assert_array_equal(image(), before)


@pytest.mark.parametrize("scheme", sorted(clutter.SCHEMES))
def test_a_scheme_comes_home_without_clutter(tmp_path, scheme):
    pytest.importorskip("aras_visual_servo_sim")
    from aras_visual_servo_study.sweep.plan import Start
    from aras_visual_servo_study.sweep.run import SweepRunner
    case = next(case for case in protocol_named("clutter").cases(tmp_path, 1) if case.name == f"{scheme}_plain")
    axes = {"x_m": 0.03, "y_m": -0.02, "z_m": -0.03, "rz_rad": 0.1}
    from aras_visual_servo.arm.robot import robot_kinematics
    from aras_visual_servo_study.sweep.space import pose_of
    robot = case.scenario.robot
    kinematics = robot_kinematics(case.scenario.urdf_xml(), robot["base_link"], robot["tip_link"])
    X_WCg = kinematics.pose(case.scenario.goal_posture(kinematics))
    joints = kinematics.by_name(kinematics.coordinates(X_WCg @ pose_of(axes)))
    row, _ = SweepRunner(case.scenario).run(Start(1, joints, axes))
    assert row["success"] == 1, (row["outcome"], row["reason"], row["detail"])
