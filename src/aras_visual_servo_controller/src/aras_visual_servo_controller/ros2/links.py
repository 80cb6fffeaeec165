"""The sockets of ROS 1 topics on the ROS 2 side, which the ROS 1 side hands over."""

import json
import select
import socket
import struct
from typing import Any, Callable, Dict, List, Tuple

READ_BYTES = 1 << 20
_LENGTH = struct.Struct("<I")


class Links:
    """Reads messages of ROS 1 from all sockets in one thread, and writes messages in the caller's.

    Args:
        link: the handover's socket, see tcpros.py.
        lost: is told number and peer of a connection that its publisher closed.
    """

    def __init__(self, link: socket.socket, lost: Callable[[int, str], None]) -> None:
        self._link, self._lost = link, lost
        link.setblocking(True)
        self._poll = select.epoll()
        self._poll.register(link.fileno(), select.EPOLLIN)
        self._readers: Dict[int, Tuple[int, str, socket.socket, bytearray]] = {}
        self._writers: Dict[int, List[socket.socket]] = {}
        self._read = memoryview(bytearray(READ_BYTES))
        #: Number of a topic -> is called with each of its messages.
        self.takes: Dict[int, Callable[[bytes], None]] = {}

    def write(self, number: int, data: bytes) -> None:
        """Sends a message to all subscribers of a topic."""
        framed = _LENGTH.pack(len(data)) + data
        for connection in list(self._writers.get(number, ())):
            try:
                connection.sendall(framed)
            except OSError:  # it has ended
                self._writers[number].remove(connection)
                connection.close()

    def read(self) -> None:
        """Serves until the ROS 1 side ends."""
        while True:
            for descriptor, _ in self._poll.poll():
                if descriptor == self._link.fileno():
                    if not self._accept():
                        return
                elif descriptor in self._readers:
                    self._receive(descriptor)

    def _accept(self):
        data, descriptors, _, _ = socket.recv_fds(self._link, 65536, 1)
        if not data:
            return False
        told = json.loads(data)
        number = told["number"]
        if not descriptors:
            for descriptor in [one for one, (of, *_) in self._readers.items() if of == number]:
                self._close(descriptor)
            return True
        connection = socket.socket(fileno=descriptors[0])
        connection.setblocking(True)
        if number in self.takes:
            self._readers[connection.fileno()] = (number, told["peer"], connection, bytearray())
            self._poll.register(connection.fileno(), select.EPOLLIN)
        else:
            self._writers.setdefault(number, []).append(connection)
        return True

    def _receive(self, descriptor):
        number, peer, connection, buffer = self._readers[descriptor]
        try:
            count = connection.recv_into(self._read)
        except OSError:
            count = 0
        if not count:
            self._close(descriptor)
            self._lost(number, peer)
            return
        buffer += self._read[:count]
        begin = 0
        while len(buffer) - begin >= _LENGTH.size:
            end = begin + _LENGTH.size + _LENGTH.unpack_from(buffer, begin)[0]
            if end > len(buffer):
                break
            self.takes[number](bytes(memoryview(buffer)[begin + _LENGTH.size:end]))
            begin = end
        del buffer[:begin]

    def _close(self, descriptor: int) -> None:
        connection: Any = self._readers.pop(descriptor)[2]
        self._poll.unregister(descriptor)
        connection.close()
