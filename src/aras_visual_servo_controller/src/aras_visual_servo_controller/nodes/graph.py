"""State of the ROS graph for the experiment node: running nodes, and established connections.

The master only knows which nodes *want* to talk to each other, and a message that is published before they are
connected is lost. Therefore the nodes themselves are asked for their connections (slave API `getBusInfo`), and a run
starts when all of them stand. Both ends are asked: a publisher notices only when it sends that a subscriber is gone,
and until then lists the old connection of one that has since unsubscribed and subscribed again. The module talks
XML-RPC with master and nodes itself and needs no ROS library.
"""

import http.client
import re
import socket
import xmlrpc.client
from typing import Any, Iterable, List, Optional, Set

_FAILURES = (OSError, http.client.HTTPException, xmlrpc.client.Error)
#: The two ports of a TCP connection, own end first, as rospy and roscpp write them.
_PORTS = re.compile(r"on port (\d+) to \[.*:(\d+) on socket")


class _TimeoutTransport(xmlrpc.client.Transport):
    def make_connection(self, host):
        connection = super().make_connection(host)
        connection.timeout = 5.0  # [s] wall time; a node that hangs must not make this one hang too
        return connection


def _server(uri):
    return xmlrpc.client.ServerProxy(uri, transport=_TimeoutTransport(), allow_none=True)


class Graph:
    """Reads the present state of the ROS graph.

    Args: caller_id: name of this node.  master_uri: as in ROS_MASTER_URI.
    """

    def __init__(self, caller_id: str, master_uri: Optional[str]) -> None:
        self._caller_id = caller_id
        self._master = _server(master_uri)

    def _answer(self, server, method, *arguments):
        """Answer of the master or a node; None if it does not come or is a refusal."""
        try:
            code, _, value = getattr(server, method)(self._caller_id, *arguments)
        except _FAILURES:
            return None
        return value if code == 1 else None

    def master_answers(self) -> bool:
        """True if there is a master."""
        return self._answer(self._master, "getPid") is not None

    def _state(self):
        """(publishers, subscribers, services), each a list of [name, nodes]; empty without a master."""
        return self._answer(self._master, "getSystemState") or ([], [], [])

    def node_uri(self, node: str) -> Optional[str]:
        """XML-RPC URI of a node, None if the master does not know it. It changes when a node is started again."""
        return self._answer(self._master, "lookupNode", node)

    def master_uri(self) -> Optional[str]:
        """URI of the master as it names itself, the same for everybody; None without a master."""
        return self._answer(self._master, "getUri")

    def running(self, nodes: Iterable[str]) -> List[str]:
        """Those of `nodes` that the master knows and that answer: one that was killed stays known to the master."""
        return [node for node in nodes if self._answers(self.node_uri(node))]

    def _answers(self, uri):
        if uri is None:
            return False
        try:
            _server(uri).getPid(self._caller_id)
        except socket.timeout:
            return True  # stopped, or busy
        except _FAILURES:
            return False
        return True

    def topics(self, namespace: Optional[str] = None) -> List[str]:
        """Sorted names of the published topics, those under `namespace` only if given."""
        publishers, _, _ = self._state()
        prefix = None if namespace is None else namespace.rstrip("/") + "/"
        return sorted(topic for topic, nodes in publishers if nodes and (prefix is None or topic.startswith(prefix)))

    def publishers(self, topic: str) -> Set[str]:
        """Set of the names of the nodes that publish a topic."""
        return {node for name, nodes in self._state()[0] if name == topic for node in nodes}

    def services(self) -> Set[str]:
        """Set of the names of the services offered."""
        return {name for name, nodes in self._state()[2] if nodes}

    def missing_connections(self, nodes: Any) -> List[str]:
        """Connections that should stand between `nodes` and do not: sorted list of (topic, publisher, subscriber)."""
        publishers, subscribers, _ = self._state()
        subscribers = {topic: set(names) & set(nodes) for topic, names in subscribers}
        wanted = {}
        for topic, names in publishers:
            if topic == "/rosout":
                continue
            for publisher in set(names) & set(nodes):
                for subscriber in subscribers.get(topic, ()):
                    wanted.setdefault(publisher, set()).add((topic, subscriber))
        received, missing = {}, []
        for publisher, pairs in wanted.items():
            missing.extend((topic, publisher, subscriber)
                           for topic, subscriber in pairs - self._standing(publisher, pairs, received))
        return sorted(missing)

    def _standing(self, publisher, pairs, received):
        """Those of `pairs`, (topic, subscriber), that this publisher is connected to over a connection that both have.

        Args: received: {subscriber: {(topic, ports)} of its incoming connections}, filled here when one is needed.
        """
        standing = set()
        for topic, subscriber, ports in self._ends(publisher, "o"):
            if (topic, subscriber) not in pairs:
                continue
            if subscriber not in received:
                received[subscriber] = {(name, ends) for name, _, ends in self._ends(subscriber, "i")}
            # Without ports it is not TCP: both ends are in one process.
            if ports is None or (topic, ports[::-1]) in received[subscriber]:
                standing.add((topic, subscriber))
        return standing

    def _ends(self, node, direction):
        """List of (topic, other node, (own port, other's port) or None) of a node's connections in that direction."""
        uri = self.node_uri(node)
        ends = []
        for entry in self._answer(_server(uri), "getBusInfo") or [] if uri else []:
            if entry[2] == direction and (len(entry) < 6 or entry[5]):
                found = _PORTS.search(entry[6]) if len(entry) > 6 else None
                ends.append((entry[4], entry[1], found and found.groups()))
        return ends
