"""The section robot.dynamics: what the simulator gets of it, and what is refused."""
from xml.etree import ElementTree

import numpy as np
import pytest

from aras_visual_servo import ParameterError, load_scenario, simulation_of

SECTION = {"damping": {"iiwa_joint_2": 3.0}, "friction": {"iiwa_joint_2": 1.5},
           "static_friction": {"iiwa_joint_2": 2.5}, "stribeck_velocity": {"iiwa_joint_2": 0.1},
           "loops": {"iiwa_joint_2": {"p": 900.0, "d": 40.0}},
           "payload": {"link": "iiwa_link_7", "mass_kg": 2.0, "position_m": [0.0, 0.0, 0.1]}}


def test_the_robot_gets_friction_payload_and_loops():
    plain = load_scenario("iiwa7")
    assert plain.urdf_xml() == plain.urdf_path.read_text(encoding="utf-8"), "run hashes hold these bytes"
    scenario = plain.with_overrides({"robot.dynamics": SECTION})
    joint = next(each for each in ElementTree.fromstring(scenario.urdf_xml()).iter("joint")
                 if each.get("name") == "iiwa_joint_2")
    found = {key: float(value) for key, value in joint.find("dynamics").attrib.items()}
    assert found == {"damping": 3.0, "friction": 1.5, "static_friction": 2.5, "stribeck_velocity": 0.1}
    assert scenario.controllers()["iiwa_joint_2_position_controller"] == {
        "type": "effort_controllers/JointPositionController", "joint": "iiwa_joint_2",
        "pid": {"p": 900.0, "i": 0.0, "d": 40.0, "i_clamp": 0.0}}
    sag = []
    for mass in (1e-9, 2.0):
        sim = simulation_of(scenario.with_overrides({"robot.dynamics.payload.mass_kg": mass,
                                                     **{f"robot.dynamics.{key}": {} for key in (
                                                         "friction", "static_friction", "stribeck_velocity")}}))
        before = np.array(sim.joint_positions)
        sim.step(3000)
        sag.append((np.array(sim.joint_positions) - before)[list(sim.joint_names).index("iiwa_joint_2")])
    assert abs(sag[1]) > abs(sag[0]) > 1e-3, "the payload bends the soft loop further"


def test_what_the_robot_lacks_is_named_with_its_key():
    with pytest.raises(ParameterError) as error:
        load_scenario("iiwa7").with_overrides({"robot.dynamics": {
            "damping": {"J9": 1.0}, "payload": {"link": "hand", "mass_kg": 1.0, "position_m": [0, 0, 0]},
            "loops": {"iiwa_joint_1": {"p": 0.0}}}})
    text = "\n".join(error.value.faults)
    for key in ("robot.dynamics.damping.J9", "robot.dynamics.loops.iiwa_joint_1.p"):
        assert key in text
    with pytest.raises(ParameterError, match="robot.dynamics.payload.link: found hand"):
        load_scenario("iiwa7").with_overrides({"robot.dynamics": {"payload": {**SECTION["payload"], "link": "hand"}}})
    for section, key in (({"static_friction": {"iiwa_joint_1": 1.0}}, "stribeck_velocity.iiwa_joint_1"),
                         ({"stribeck_velocity": {"iiwa_joint_1": 1.0}}, "static_friction.iiwa_joint_1"),
                         ({**SECTION, "static_friction": {"iiwa_joint_2": 1.0}}, "static_friction.iiwa_joint_2")):
        with pytest.raises(ParameterError, match="robot.dynamics." + key):
            load_scenario("iiwa7").with_overrides({"robot.dynamics": section})
    with pytest.raises(ParameterError, match="robot.dynamics.loops.world_joint"):
        load_scenario("iiwa7").with_overrides({"robot.dynamics": {"loops": {"world_joint": {"p": 1.0}}}})
