"""Frames over the local socket between the two sides of the relay, which have different Python paths."""

import json
import socket
import struct
import sys
import threading
from typing import Any, Iterator, Tuple

#: Number of the entry whose frames are JSON objects; the others carry messages.
CONTROL = 0
#: A message goes from thread to thread on its way. Within Python's own 5 ms two of them would seldom change places [s].
SWITCH_S = 2e-4
#: Number of a call of a service or of a goal, and with the status of its end, at the beginning of a frame.
CALL, RESULT = struct.Struct("<Q"), struct.Struct("<QB")
_HEAD = struct.Struct("<IH")  # length, number of the entry


class Channel:
    """Sends and receives frames. Any thread may send; one thread receives."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._lock = threading.Lock()
        sys.setswitchinterval(SWITCH_S)
        link.settimeout(None)  # rospy sets another default
        link.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4 << 20)

    def send(self, number: int, data: bytes) -> None:
        """Sends one frame. Raises OSError: the other side has ended."""
        with self._lock:
            if len(data) < 65536:
                self._link.sendall(_HEAD.pack(len(data), number) + data)
            else:
                self._link.sendall(_HEAD.pack(len(data), number))
                self._link.sendall(data)

    def tell(self, **values: Any) -> None:
        """Sends a JSON object."""
        self.send(CONTROL, json.dumps(values).encode())

    def frames(self) -> Iterator[Tuple[int, bytes]]:
        """Yields (number, data) until the other side closes the socket."""
        stream = self._link.makefile("rb", buffering=1 << 18)
        try:
            while True:
                head = stream.read(_HEAD.size)
                if len(head) < _HEAD.size:
                    return
                length, number = _HEAD.unpack(head)
                data = stream.read(length)
                if len(data) < length:
                    return
                yield number, data
        except OSError:
            return
