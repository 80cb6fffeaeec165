"""Where joint_state_publisher has the joints of a URDF."""
from joint_state_publisher.joints import Joints

URDF = """<robot name='r'>
  <joint name='fixed' type='fixed'/>
  <joint name='turn' type='continuous'/>
  <joint name='slide' type='prismatic'><limit lower='0.2' upper='0.6'/></joint>
  <joint name='bend' type='revolute'><limit lower='-1' upper='1'/></joint>
  <joint name='finger' type='prismatic'><limit lower='0' upper='1'/>
    <mimic joint='bend' multiplier='2' offset='0.1'/></joint>
  <joint name='tip' type='prismatic'><limit lower='0' upper='1'/><mimic joint='finger' multiplier='-1'/></joint>
</robot>"""


def positions(joints):
    return {name: round(joints.position(name), 12) for name in joints.names}


def test_joints_begin_at_zero_or_in_the_middle_of_limits_that_exclude_it():
    assert positions(Joints(URDF)) == {"turn": 0.0, "slide": 0.4, "bend": 0.0, "finger": 0.1, "tip": -0.1}


def test_zeros_and_other_publishers_move_joints_and_those_that_follow_them():
    joints = Joints(URDF, zeros={"turn": 0.5})
    joints.update("bend", 0.3, 1.5, None)
    joints.update("of_another_robot", 1.0, None, None)
    assert positions(joints) == {"turn": 0.5, "slide": 0.4, "bend": 0.3, "finger": 0.7, "tip": -0.7}
    assert joints.rate("finger", "velocity") == 3.0 and joints.rate("turn", "velocity") is None


def test_mimics_can_be_ignored_or_given_by_the_parameter():
    assert "finger" in Joints(URDF, use_mimic=False).free
    joints = Joints(URDF, zeros={"bend": 0.5}, dependent={"turn": {"parent": "bend", "factor": 3}})
    assert joints.position("turn") == 1.5


def test_a_circle_of_followers_ends():
    circle = URDF.replace("</robot>", "").replace("<joint name='turn' type='continuous'/>",
                                                  "<joint name='turn' type='continuous'><mimic joint='turn'/></joint>")
    assert Joints(circle + "</robot>").position("turn") == 0.0
