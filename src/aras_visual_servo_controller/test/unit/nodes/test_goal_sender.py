"""Parts of the nodes without ROS: goals, joint states, the launch file, the end of an experiment."""

import io
import pathlib
from types import SimpleNamespace

import numpy as np
import pytest
import roslaunch.config
import roslaunch.xmlloader
from genpy import Time
from hypothesis import given, settings, strategies as st
from sensor_msgs.msg import JointState

from aras_visual_servo import ShapeError
from aras_visual_servo_controller.nodes import experiment
from aras_visual_servo_controller.nodes.calls import AGAIN_S, GoalSender
from aras_visual_servo_controller.nodes.conversions import JointReader, LazyJointState
from aras_visual_servo_controller.nodes.experiment import CLOSING_S, ExperimentNode


def goal(name):
    return SimpleNamespace(goal_id=SimpleNamespace(id=name))


@pytest.fixture
def sent():
    return []


@pytest.fixture
def sender(sent):
    return GoalSender(sent.append)


def test_a_goal_that_is_not_taken_is_sent_again_as_the_same_goal(sender, sent):
    first = goal("first")
    sender.send(first, 10.0)
    sender.look(10.0 + 0.9 * AGAIN_S)
    assert sent == [first]
    sender.heard({"first": True, "other": False})  # seen, but pending
    sender.look(10.0 + AGAIN_S)
    assert sent == [first, first] and not sender.taken
    sender.look(10.0 + 1.5 * AGAIN_S)
    assert len(sent) == 2


def test_a_goal_that_was_taken_is_not_sent_again(sender, sent):
    sender.send(goal("first"), 10.0)
    sender.heard({"first": False})
    sender.heard({})  # forgotten by the server, long after its end
    sender.look(100.0)
    assert len(sent) == 1 and sender.taken


def test_the_next_goal_is_one_that_must_be_taken_anew(sender, sent):
    sender.look(5.0)
    assert sent == []
    sender.send(goal("first"), 10.0)
    sender.heard({"first": False})
    sender.send(goal("second"), 20.0)
    assert not sender.taken and sender.goal_id == "second"
    sender.heard({"first": False})
    sender.look(20.0 + AGAIN_S)
    assert [one.goal_id.id for one in sent] == ["first", "second", "second"]


NAMES = st.sampled_from(["a", "b", "c", "other", ""])


@settings(deadline=None, max_examples=500, derandomize=True)
@given(st.lists(st.tuples(st.lists(NAMES, max_size=5), st.lists(st.floats(), max_size=5)), min_size=1, max_size=4))
def test_positions_are_those_of_the_names_or_refused(messages):
    reader = JointReader(["a", "b"])
    for names, positions in messages:
        message = JointState(name=names, position=positions)
        if {"a", "b"} <= set(names) and len(names) == len(positions):
            found = reader.positions(message)
            assert list(map(repr, map(float, found))) == [repr(positions[names.index(name)]) for name in ("a", "b")]
        else:
            with pytest.raises(ShapeError, match="joint_states: found .*(missing|allowed)"):
                reader.positions(message)


def part(stamp_ms, **positions):
    message = JointState(name=list(positions), position=list(positions.values()))
    message.header.stamp.secs, message.header.stamp.nsecs = divmod(stamp_ms * 1_000_000, 1_000_000_000)
    return message


def test_joint_states_of_one_stamp_are_merged_by_name():
    reader = JointReader(["a", "b", "c"])
    assert reader.merged(part(10, b=2.0, other=9.0), 0.0) is None
    assert reader.merged(part(10, other=9.0), 0.0) is None
    assert reader.merged(part(10, c=3.0, a=1.0), 0.0).tolist() == [1.0, 2.0, 3.0]
    assert reader.merged(part(20, c=3.0, a=1.5), 0.0) is None  # b is of another stamp
    assert reader.merged(part(20, b=2.5), 0.0).tolist() == [1.5, 2.5, 3.0]
    assert reader.merged(part(5, b=2.0, c=3.0, a=1.0), 0.0).tolist() == [1.0, 2.0, 3.0]


def test_parts_that_are_too_far_apart_are_not_merged_and_the_missing_joint_is_named():
    reader = JointReader(["a", "b"])
    assert reader.merged(part(1000, a=1.0), 0.1) is None
    assert reader.merged(part(1099, b=2.0), 0.1).tolist() == [1.0, 2.0]
    assert reader.merged(part(1201, a=3.0), 0.1) is None
    with pytest.raises(ShapeError, match="found a, missing b"):
        reader.merged(part(2100, a=3.0), 0.1)
    assert np.isnan(reader.merged(part(2101, b=np.nan), 0.1)).tolist() == [False, True]


def test_time_that_goes_back_begins_anew():
    reader = JointReader(["a", "b"])
    reader.merged(part(90_000, a=1.0), 0.1), reader.merged(part(90_000, b=1.0), 0.1)
    assert reader.merged(part(10, a=3.0), 0.1) is None
    assert reader.merged(part(20, b=4.0), 0.1).tolist() == [3.0, 4.0]


def lazy(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return LazyJointState().deserialize(buffer.getvalue())


def test_a_message_that_names_all_joints_is_whole_whatever_came_before():
    reader = JointReader(["a", "b"])
    for message, whole in ((part(10, a=1.0), False), (part(10, b=1.0, a=2.0), True), (part(20, b=3.0, a=4.0), True),
                           (part(20, a=1.0), False), (part(30, b=1.0, c=2.0, a=3.0), True), (part(30, b=1.0), False),
                           (part(40, b=1.0, a=2.0), True)):
        assert reader.is_whole(lazy(message)) == whole, message


LAUNCH = pathlib.Path(__file__).resolve().parents[3] / "launch" / "servo.launch"


def load(*arguments):
    """(nodes by their whole names, values of the parameters by their names) of servo.launch with these arguments."""
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(str(LAUNCH), config, argv=[str(LAUNCH), *arguments],
                                                           verbose=False)
    return {node.namespace + node.name: node for node in config.nodes}, \
        {name: parameter.value for name, parameter in config.params.items()}


@pytest.fixture(scope="module")
def plain():
    return load("ns:=left")


@pytest.fixture(scope="module")
def shown():
    return load("ns:=left", "rviz:=true")


def test_rviz_adds_itself_and_what_feeds_it_and_no_second_source_of_what_the_simulator_says(plain, shown):
    assert set(shown[0]) - set(plain[0]) == {"/left/rviz", "/left/rviz_view"}
    assert set(plain[0]) <= set(shown[0])


def test_rviz_opens_the_file_of_the_description_with_the_names_of_its_namespace(shown):
    rviz = shown[0]["/left/rviz"]
    words = rviz.args.split()
    assert words[0] == "-d" and pathlib.Path(words[1]).is_file() and pathlib.Path(words[1]).name == "view.rviz"
    assert ("/aras_visual_servo/camera/image_raw", "camera/image_raw") in map(tuple, rviz.remap_args)


def test_with_rviz_a_run_is_as_fast_as_one_can_watch_and_the_graph_outlives_it(plain, shown):
    assert shown[1]["/left/scenario"]["time"]["real_time_factor"] == 1.0
    assert plain[1]["/left/scenario"]["time"]["real_time_factor"] == 0.0
    assert plain[0]["/left/experiment"].required and not shown[0]["/left/experiment"].required


def test_a_factor_that_is_given_wins_over_that_for_watching():
    _, parameters = load("rviz:=true", "real_time_factor:=3.0")
    assert parameters["/aras_visual_servo/scenario"]["time"]["real_time_factor"] == 3.0


DONE_NS, PERIOD_NS = 900_000_000, 1_000_000
END_NS = DONE_NS + round(CLOSING_S * 1e9)


def status(stamp_ns):
    """A paused SimStatus."""
    return SimpleNamespace(header=SimpleNamespace(stamp=Time(0, stamp_ns)), paused=True)


def ending(now_ns, told_ns):
    """(node, steps asked for): a node whose paused simulator stands at now_ns and was last heard of at told_ns."""
    node, asked = object.__new__(ExperimentNode), []

    def step(steps):
        asked.append(steps)
        stamp_ns = now_ns + sum(asked) * PERIOD_NS
        if steps:
            node._status = status(stamp_ns)
        return SimpleNamespace(stamp=Time(0, stamp_ns))

    node._step, node._done_ns, node._status = step, DONE_NS, status(told_ns)
    node._scenario = SimpleNamespace(sim={"period_s": PERIOD_NS * 1e-9})
    return node, asked


@pytest.mark.parametrize("told_ns", [0, DONE_NS, 1_500_000_000])
def test_a_run_ends_at_its_tick_also_where_the_last_status_is_of_before_the_pause(told_ns):
    node, asked = ending(1_500_000_000, told_ns)
    node._close_run()
    assert sum(asked) * PERIOD_NS == END_NS - 1_500_000_000


@pytest.mark.parametrize("now_ns, warnings", [(END_NS, 0), (END_NS + PERIOD_NS, 1)])
def test_a_pause_that_came_too_late_is_told_and_nothing_is_stepped(monkeypatch, now_ns, warnings):
    told = []
    monkeypatch.setattr(experiment.rospy, "logwarn", lambda *words: told.append(words))
    node, asked = ending(now_ns, now_ns)
    node._close_run()
    assert sum(asked) == 0 and len(told) == warnings


@pytest.mark.parametrize("done_ns, told_ns, answered", [
    (None, DONE_NS, False), (DONE_NS, 0, False), (DONE_NS, DONE_NS, False), (DONE_NS, DONE_NS + PERIOD_NS, True)])
def test_the_last_image_is_answered_once_time_has_gone_on_behind_it(done_ns, told_ns, answered):
    node, _ = ending(told_ns, told_ns)
    node._done_ns = done_ns
    assert node._answered() is answered
