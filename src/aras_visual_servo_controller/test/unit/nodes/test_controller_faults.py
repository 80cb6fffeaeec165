"""Parts of the controller node: faults, the bars of the null space, connections of the graph."""

import threading
import xmlrpc.server

import numpy as np
import pytest
from bench import config
from toy_plant import arm, GOAL, START

from aras_visual_servo import Features, Servo, ServoRecord, Session, Status
from aras_visual_servo.arm.redundancy import FREE
from aras_visual_servo_controller.nodes import controller
from aras_visual_servo_controller.nodes.graph import Graph
from aras_visual_servo_controller.nodes.null_space_bars import CAMERA, draw, NULL_SPACE, shares

STAMP_NS = 40_000_000


class Broken:
    """A sequence that raises at every image, and does not help to stop."""

    phase, done, teach_stamp_ns, result, kinematics = "servo", False, None, None, arm()

    def step(self, observation):
        raise ZeroDivisionError("a law of somebody else")

    def start(self, servo_only):
        pass

    def stop(self, stamp_ns, reason):
        raise ZeroDivisionError("nor can it stop")


class Message:
    class header:
        frame_id = "camera_optical_frame"


class Joints:
    def unpack(self):
        return None

    def positions(self, _):
        return arm().vector(GOAL)


@pytest.fixture
def node(monkeypatch):
    """A node without ROS around it, which servos; what it sends, publishes and reports is in lists."""
    node = object.__new__(controller.ControllerNode)
    node._session = Session(Broken(), input_timeout_s=0.2, time_limit_s=20.0)
    node._session.active = True
    node._sequence, node._joints = Broken(), Joints()
    node.sent, node.records, node.finished = [], [], []
    node._send, node._publish_state, node._finish = node.sent.append, node.records.append, node.finished.append
    monkeypatch.setattr(controller.convert, "now_ns", lambda: STAMP_NS)
    monkeypatch.setattr(controller.rospy, "logerr", lambda *_: None)
    return node


def test_an_exception_sends_zero_velocity_to_every_joint_and_ends_the_goal(node):
    node._answer(STAMP_NS, Message, Joints())
    [command] = node.sent
    assert command.stamp_ns == STAMP_NS and not command.position
    assert command.velocity == dict.fromkeys(arm().joint_names, 0.0)
    [record] = node.records
    assert record.status == Status.FAULT and "ZeroDivisionError: a law of somebody else" in record.status_text
    assert node.finished == [record] and not node._session.active


def test_without_a_goal_an_exception_stops_the_arm_too_and_reports_nothing(node):
    node._session.active = False
    node._answer(STAMP_NS, Message, Joints())
    assert node.sent[0].velocity == dict.fromkeys(arm().joint_names, 0.0)
    assert node.records[0].status == Status.FAULT and node.finished == []


def test_an_exception_after_the_command_was_sent_is_followed_by_a_stop(node):
    """The record cannot be published: the arm must not go on with the velocity that it was given."""
    moving = node._session.standstill(STAMP_NS)
    moving.velocity = dict.fromkeys(arm().joint_names, 0.3)
    record = ServoRecord(STAMP_NS, Status.SERVOING)
    node._session.answer = lambda *_: (moving, record)

    def publish(found):
        if found is record:
            raise OSError("closed")
        node.records.append(found)

    node._publish_state = publish
    node._answer(STAMP_NS, Message, Joints())
    assert node.sent[0] is moving and node.sent[-1].velocity == dict.fromkeys(arm().joint_names, 0.0)
    assert node.records[-1].status == Status.FAULT


def test_features_that_are_fit_for_nothing_never_raise(node):
    class Headless(Message):
        pass

    node._seen = lambda *_: (Features(), np.full(6, np.nan), "")
    node._answer(STAMP_NS, Headless, Joints())
    assert node.sent[-1].velocity == dict.fromkeys(arm().joint_names, 0.0)


ROUNDING = 1e-10  # eps times the largest 1 / sigma and the largest scaled entry, with room for the SVD
LENGTH_M, THRESHOLD = 0.05, 0.02
SCALE = np.array([1.0 / LENGTH_M] * 3 + [1.0] * 3)
Q_DOT = np.array([0.3, -0.2, 0.4, 0.1, -0.5, 0.25])
WEIGHTS = {"J1": 3.0, "gantry": 2.0}


def servo(**changes):
    kinematics = arm()
    return kinematics, Servo(kinematics, config(**changes))


@pytest.mark.parametrize("place", [GOAL, START, {**START, "J5": START["J5"] + 0.0004}])
@pytest.mark.parametrize("weights", [{}, WEIGHTS])
def test_parts_sum_to_the_velocity_and_the_null_part_leaves_the_camera_at_rest(place, weights):
    kinematics, split_by = servo(inverse={"joint_weights": weights})
    q = kinematics.vector(place)
    camera, null = split_by.split(q, Q_DOT)
    np.testing.assert_allclose(camera + null, Q_DOT, rtol=0.0, atol=1e-15)
    assert np.linalg.norm(null) > 0.1  # looking straight down, J1 and J6 may turn against each other
    # FREE says how much of a free motion the camera may see; with weights its size is that of the weighted joints.
    size = np.linalg.norm(null * [weights.get(name, 1.0) for name in kinematics.joint_names])
    assert np.linalg.norm(SCALE * (kinematics.jacobian(q) @ null)) <= FREE * THRESHOLD * size + ROUNDING
    np.testing.assert_allclose(split_by.split(q, null)[1], null, atol=ROUNDING)
    np.testing.assert_allclose(split_by.split(q, camera)[1], 0.0, atol=ROUNDING)


def test_an_arm_that_has_nothing_to_spare_shows_no_null_space_motion():
    kinematics, split_by = servo()
    q = kinematics.vector({**START, "J5": START["J5"] + 0.3})  # tilted: six joints for six degrees of freedom
    camera, null = split_by.split(q, Q_DOT)
    assert (null == 0.0).all() and (camera == Q_DOT).all()


def test_the_twist_of_the_inverse_is_camera_motion_and_its_free_part_is_not():
    kinematics, _ = servo()
    arm_motion = Servo(kinematics, config())._arm
    q = kinematics.vector(START)
    inverse = arm_motion.at(q)[1]
    of_twist, free = inverse.joint_velocity(np.array([0.02, -0.01, 0.03, 0.0, 0.0, 0.2])), inverse.free(Q_DOT)
    camera, null = arm_motion.split(q, of_twist + free)
    np.testing.assert_allclose(camera, of_twist, atol=ROUNDING)
    np.testing.assert_allclose(null, free, atol=ROUNDING)


def test_shares_are_parts_of_the_velocity_limits():
    limits = np.array([2.0, 4.0, np.inf])
    q_dot = np.array([1.0, -2.0, 0.5])
    camera, null = shares(lambda q, q_dot: (0.75 * q_dot, 0.25 * q_dot), np.zeros(3), q_dot, limits)
    np.testing.assert_allclose(camera, [0.375, -0.375, 0.375])
    np.testing.assert_allclose(null, [0.125, -0.125, 0.125])


@pytest.mark.parametrize("q, q_dot", [([], []), ([np.nan, 0.0], [0.0, 0.0]), ([0.0, 0.0], [np.inf, 0.0])])
def test_without_positions_or_velocities_there_are_no_bars(q, q_dot):
    camera, null = shares(None, q, q_dot, np.ones(2))  # nothing to split: it is not called
    assert (camera == 0.0).all() and (null == 0.0).all() and len(camera) == len(null) == 2


def area(picture, colour, columns):
    return int((picture[80:, columns] == colour).all(axis=2).sum())


def test_bars_point_to_the_side_of_the_sign_and_stay_in_the_picture():
    names, still = ("J1", "J2"), np.zeros(2)
    left, right, rest = slice(74, 223), slice(228, 377), draw(names, still, still)
    one, two = draw(names, np.array([0.25, 0.0]), still), draw(names, np.array([1.0, 0.0]), still)
    assert one.shape == rest.shape == (90 + 2 * 40 + 6, 440, 3) and one.dtype == np.uint8
    assert area(one, CAMERA, right) > 1000 and area(one, CAMERA, left) == area(rest, CAMERA, left)
    assert area(two, CAMERA, right) == pytest.approx(2 * area(one, CAMERA, right), rel=0.05)  # square root of 4
    assert (draw(names, np.array([9.0, 0.0]), still)[:, :377] == two[:, :377]).all()  # longer than the axis: cut there
    both = draw(names, still, np.array([0.0, -0.25]))
    assert area(both, NULL_SPACE, left) > 1000 and area(both, NULL_SPACE, right) == area(rest, NULL_SPACE, right)


NODES = ("/controller", "/sim")
TOPIC = "/servo_state"


class FakeNode:
    """Master and node at once, which answer with `state` and `connections`."""

    def __init__(self):
        self.state, self.uris, self.connections = [[], [], []], {}, []
        self._server = xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True)
        for name, answer in (("getSystemState", lambda _: self.state), ("getBusInfo", lambda _: self.connections),
                             ("lookupNode", lambda _, node: self.uris[node])):
            self._server.register_function(lambda *words, answer=answer: (1, "", answer(*words)), name)
        self.uri = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        self._thread.start()

    def close(self):
        self._server.shutdown()
        self._server.server_close()


@pytest.fixture
def nodes():
    """(master, controller, sim); the controller publishes TOPIC, and sim subscribes to it."""
    found = [FakeNode() for _ in range(3)]
    master, controller, sim = found
    master.uris = {"/controller": controller.uri, "/sim": sim.uri}
    master.state = [[[TOPIC, ["/controller"]]], [[TOPIC, ["/sim"]]], []]
    yield found
    for node in found:
        node.close()


def missing(master):
    return Graph("/test", master.uri).missing_connections(NODES)


def outgoing(subscriber_port, topic=TOPIC, node="/sim"):
    return [1, node, "o", "TCPROS", topic, True, f"TCPROS connection on port 500 to [127.0.0.1:{subscriber_port} on "
                                                 "socket 8]"]


def incoming(port, topic=TOPIC):
    return [2, "http://127.0.0.1:9/", "i", "TCPROS", topic, True, f"TCPROS connection on port {port} to [localhost:500 "
                                                                  "on socket None]"]


def test_a_connection_that_both_ends_have_stands(nodes):
    master, controller, sim = nodes
    assert missing(master) == [(TOPIC, "/controller", "/sim")]
    controller.connections, sim.connections = [outgoing(600)], [incoming(600)]
    assert missing(master) == []


def test_a_connection_that_the_subscriber_has_given_up_does_not_stand(nodes):
    master, controller, sim = nodes
    controller.connections = [outgoing(600)]  # of a subscription before; the publisher has not noticed its end
    for of_sim in ([], [incoming(601)], [incoming(600, topic="/other")]):
        sim.connections = of_sim
        assert missing(master) == [(TOPIC, "/controller", "/sim")]
    controller.connections, sim.connections = [outgoing(600), outgoing(601)], [incoming(601)]
    assert missing(master) == []


def test_a_connection_that_is_marked_as_closed_does_not_stand(nodes):
    master, controller, sim = nodes
    controller.connections, sim.connections = [outgoing(600)], [incoming(600)]
    controller.connections[0][5] = False
    assert missing(master) == [(TOPIC, "/controller", "/sim")]


def test_a_connection_within_one_process_has_no_ports(nodes):
    master, controller, _ = nodes
    controller.connections = [[1, "/sim", "o", "INTRAPROCESS", TOPIC, True, ""]]
    assert missing(master) == []


def test_nodes_that_do_not_answer_have_no_connections(nodes):
    master, controller, sim = nodes
    controller.connections, sim.connections = [outgoing(600)], [incoming(600)]
    sim.close()
    assert missing(master) == [(TOPIC, "/controller", "/sim")]
