"""Connections of ROS 1 topics: negotiated here, read and written by the ROS 2 side.

A message so takes one step less on its way. The ROS 2 side gets the sockets themselves, over a socket of the operating
system (SCM_RIGHTS), each with a JSON object {number, peer}. An object without a socket takes all of its number back.
"""

import json
import socket
import struct
import threading
import xmlrpc.client
from typing import Any, Dict, Set

import rosgraph
import rospy
from rosgraph.network import decode_ros_handshake_header, encode_ros_handshake_header

from aras_visual_servo import ArasError

TIMEOUT_S = 5.0  # wall time for a publisher to answer
_LENGTH = struct.Struct("<I")


class Handover:
    """Gives sockets to the ROS 2 side. Any thread may call it."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        link.settimeout(None)  # rospy sets another default

    def give(self, number: int, peer: str, connection: Any) -> None:
        """Gives a copy of a connected socket. Raises OSError: the other side has ended."""
        socket.send_fds(self._link, [json.dumps({"number": number, "peer": peer}).encode()], [connection.fileno()])

    def take_back(self, number: int) -> None:
        """Closes all that was given under a number."""
        self._link.sendall(json.dumps({"number": number}).encode())


class Subscription:
    """A topic that ROS 2 nodes may listen to. While one does, each publisher's connection is given away."""

    def __init__(self, handover: Handover, number: int, topic: str) -> None:
        self._handover, self._number, self._topic = handover, number, topic
        self._lock = threading.Lock()
        self._wanted = self._begun = False
        self._peers: Set[str] = set()
        rospy.on_shutdown(self._end)

    @property
    def connected(self) -> bool:
        """Whether messages come, or none are wanted."""
        return not self._wanted or bool(self._peers)

    def listen(self, on: bool) -> None:
        """Begins or ends to listen."""
        self._wanted = on
        threading.Thread(target=self.update, daemon=True).start()  # publishers may be slow to answer

    def update(self) -> None:
        """Connects to publishers that are new, if messages are wanted, or else closes all connections."""
        with self._lock:
            if not self._wanted:
                self._end()
                return
            uris = rosgraph.Master(rospy.get_name()).registerSubscriber(self._topic, "*", rospy.get_node_uri())
            self._begun = True
            for uri in set(uris) - self._peers:
                try:
                    with connection_to(uri, self._topic) as connection:
                        self._handover.give(self._number, uri, connection)
                    self._peers.add(uri)
                except (OSError, ArasError, xmlrpc.client.Error) as error:
                    rospy.logdebug("%s: %s: %s", self._topic, uri, error)  # a publisher that is ending, for example

    def lost(self, peer: str) -> None:
        """A publisher has closed its connection."""
        self._peers.discard(peer)

    def _end(self):
        if self._begun:
            self._begun = False
            rosgraph.Master(rospy.get_name()).unregisterSubscriber(self._topic, rospy.get_node_uri())
            self._handover.take_back(self._number)
            self._peers.clear()


class Publication(rospy.SubscribeListener):
    """A topic that ROS 2 nodes may publish on. The connection of each subscriber is given away."""

    def __init__(self, handover: Handover, number: int, publisher: rospy.Publisher) -> None:
        self._handover, self._number, self._impl = handover, number, publisher.impl
        self._given: Dict[int, Any] = {}
        publisher.impl.add_subscriber_listener(self)

    def listen(self, on: bool) -> None:
        """A ROS 2 node began or ended to publish."""

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """A subscriber has connected."""
        for connection in list(self._impl.connections):
            if id(connection) not in self._given:
                self._given[id(connection)] = connection  # kept, so that the number stays its own
                self._handover.give(self._number, connection.endpoint_id, connection.socket)


def connection_to(publisher: str, topic: str) -> socket.socket:
    """Returns a socket on which a publisher sends the messages of a topic, each after its length of 4 bytes.

    Args:
        publisher: XML-RPC address of the node.
    Raises:
        ArasError: the publisher refuses.  OSError: it does not answer.
    """
    node = xmlrpc.client.ServerProxy(publisher)
    code, text, protocol = node.requestTopic(rospy.get_name(), topic, [["TCPROS"]])  # type: ignore[misc]
    if code != 1 or not protocol:
        raise ArasError(str(text))
    host, port = str(protocol[1]), int(str(protocol[2]))
    connection = socket.create_connection((host, port), TIMEOUT_S)
    try:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.sendall(encode_ros_handshake_header({
            "callerid": rospy.get_name(), "topic": topic, "type": "*", "md5sum": "*", "message_definition": "",
            "tcp_nodelay": "1"}))
        # Not a byte more: messages follow.
        head = connection.recv(_LENGTH.size, socket.MSG_WAITALL)
        length, = _LENGTH.unpack(head)
        answer = decode_ros_handshake_header(head + connection.recv(length, socket.MSG_WAITALL))
        if "error" in answer:
            raise ArasError(str(answer["error"]))
    except BaseException:
        connection.close()
        raise
    return connection
