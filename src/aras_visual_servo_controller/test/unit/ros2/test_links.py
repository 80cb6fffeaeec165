"""Sockets of ROS 1 topics on the ROS 2 side: messages in pieces, several subscribers, ends."""
import json
import queue
import socket
import struct
import threading

import pytest

from aras_visual_servo_controller.ros2.links import Links
from aras_visual_servo_controller.ros2.tcpros import Handover

WAIT_S = 10.0


def framed(*messages):
    return b"".join(struct.pack("<I", len(message)) + message for message in messages)


class Sides:
    """Links that read in a thread, and the other side of their socket."""

    def __init__(self):
        give, get = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.give, self.lost, self.seen = give, queue.Queue(), queue.Queue()
        self.links = Links(get, lambda *what: self.lost.put(what))
        self.links.takes[1] = self.seen.put
        self.handover = Handover(give)
        self.thread = threading.Thread(target=self.links.read, daemon=True)
        self.thread.start()

    def given(self, number, peer="a"):
        """Our end of a connection of which the links have the other."""
        ours, theirs = socket.socketpair()
        with theirs:
            self.handover.give(number, peer, theirs)
        ours.settimeout(WAIT_S)
        return ours


@pytest.fixture
def sides():
    made = Sides()
    yield made
    made.give.close()
    made.thread.join(WAIT_S)
    assert not made.thread.is_alive()


def test_messages_come_whole_however_their_bytes_come(sides):
    messages = [b"", b"x", bytes(range(256)) * 9000]  # the last is more than one read
    data = framed(*messages)
    with sides.given(1) as publisher:
        for cut in (0, 3, 5, 9):
            publisher.sendall(data[:cut])
            publisher.sendall(data[cut:])
            assert [sides.seen.get(timeout=WAIT_S) for _ in messages] == messages


def test_an_ended_publisher_is_told_and_one_taken_back_is_closed(sides):
    sides.given(1, "first").close()
    assert sides.lost.get(timeout=WAIT_S) == (1, "first")
    with sides.given(1, "second") as publisher:
        sides.handover.take_back(1)
        assert publisher.recv(1) == b""
    assert sides.lost.empty()


def test_subscribers_get_every_message_and_an_ended_one_is_left_out(sides):
    with sides.given(2) as one:
        other = sides.given(2)
        with sides.given(1) as publisher:  # after its message the two before it are known
            publisher.sendall(framed(b"now"))
            sides.seen.get(timeout=WAIT_S)
        sides.links.write(2, b"abc")
        assert one.recv(99) == other.recv(99) == framed(b"abc")
        other.close()
        for _ in range(3):
            sides.links.write(2, b"d")
            assert one.recv(99) == framed(b"d")


def test_a_handover_names_number_and_peer():
    give, get = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with give, get, socket.socket() as any_socket:
        Handover(give).give(7, "http://x:1/", any_socket)
        data, descriptors, _, _ = socket.recv_fds(get, 65536, 1)
        socket.socket(fileno=descriptors[0]).close()
        assert json.loads(data) == {"number": 7, "peer": "http://x:1/"}
