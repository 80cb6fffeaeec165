"""Which connections stand, asked of a master and of nodes that answer what a test says."""
import threading
import xmlrpc.server

import pytest

from aras_visual_servo_controller.nodes.graph import Graph

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
