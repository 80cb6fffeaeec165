"""The ROS 2 side of the relay: a program for the Python of build/ros2, which `Relay` starts with two sockets.

It knows no topic by name. The ROS 1 side says what to offer, and hands over the connections of topics (`links.py`).
Their messages become CDR bytes here. A topic of ROS 1 is asked for only while a ROS 2 node listens to it.
"""

import importlib
import itertools
import json
import os
import signal
import socket
import sys
import threading
import time
import traceback
from pathlib import Path
from typing import Any, Callable, Dict, Optional

import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

sys.path.insert(0, str(Path(__file__).resolve().parent))
import cdr  # noqa: E402
from channel import CALL, CONTROL, RESULT, Channel  # noqa: E402
from links import Links  # noqa: E402

#: Messages that wait for a slow listener: as many as ROS 2's profile for sensor data keeps, and of commands more.
SENSOR_DEPTH, COMMAND_DEPTH = 5, 1000
LOOK_PERIOD_S = 0.05  # wall time between looks for listeners
#: actionlib's status of a goal that was reached, and of one that was stopped on request.
SUCCEEDED, PREEMPTED = 3, 2


def type_named(name: str, folder: str) -> Any:
    """Returns the class of "package/Type" of a folder msg, srv or action; None: this environment has none.

    A package that only ROS 1 has is found among Debian's, and is none.
    """
    package, _, kind = name.partition("/")
    try:
        found = getattr(importlib.import_module(f"{package}.{folder}"), kind, None)
    except ImportError:
        return None
    return found if hasattr(found, "__import_type_support__") else None


class Door:
    """Offers what the ROS 1 side tells it to.

    Commands have a node and a thread of their own: an executor takes the longer the more its node offers.
    """

    def __init__(self, channel: Channel, link: socket.socket, name: str) -> None:
        self._channel = channel
        self._links = Links(link, lambda number, peer: channel.tell(do="lost", number=number, peer=peer))
        threading.Thread(target=self._links.read, daemon=True).start()
        self.node, self._commands = (rclpy.create_node(one, start_parameter_services=False, enable_rosout=False)
                                     for one in (name, name + "_commands"))
        for node in (self.node, self._commands):
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            threading.Thread(target=executor.spin, daemon=True).start()
        self._takes: Dict[int, Callable[[bytes], None]] = {}
        self._others: Dict[int, Callable[[], int]] = {}
        self._had_others: Dict[int, bool] = {}
        self._looking = threading.Lock()
        self._calls: Dict[int, Any] = {}
        self._goals: Dict[int, Any] = {}
        self._last_call = 0

    # --- from the ROS 1 side --------------------------------------------------------------------------------------

    def read(self) -> None:
        """Serves the ROS 1 side until it closes the socket."""
        for number, data in self._channel.frames():
            if number == CONTROL:
                told = json.loads(data)
                getattr(self, f"do_{told.pop('do')}")(**told)
            else:
                self._takes[number](data)

    def do_types(self, names: list) -> None:
        """Answers with the fields of each message type, null for a type that is not installed."""
        found = {name: type_named(name, "msg") for name in names}
        self._channel.tell(do="types", fields={name: kind and list(kind.get_fields_and_field_types().items())
                                               for name, kind in found.items()})

    def do_out(self, number: int, topic: str, type: str, kept: bool, layout: cdr.Layout) -> None:
        """Offers a topic. Args: kept: late listeners get the last message."""
        # Reliable offers suit listeners that ask for the profile of sensor data, as well as those that ask for no loss.
        profile = QoSProfile(depth=1 if kept else SENSOR_DEPTH, reliability=ReliabilityPolicy.RELIABLE,
                             durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE)
        publisher = self.node.create_publisher(type_named(type, "msg"), topic, profile)
        convert = cdr.to_cdr(type, layout)
        self._links.takes[number] = lambda data: publisher.publish(convert(data, 0))
        self._others[number] = publisher.get_subscription_count

    def do_into(self, number: int, topic: str, type: str, layout: Optional[cdr.Layout]) -> None:
        """Takes a topic. Args: layout: None: the ROS 1 side takes the messages; else its subscribers do."""
        convert = cdr.from_cdr(type, layout) if layout else None
        count = itertools.count(1)

        def take(data: bytes) -> None:
            if convert is None:
                self._channel.send(number, data)
                return
            try:
                self._links.write(number, convert(data, next(count)))
            except ValueError as error:
                self._channel.tell(do="warn", text=f"{topic}: {error}")
        self._commands.create_subscription(type_named(type, "msg"), topic, take, QoSProfile(depth=COMMAND_DEPTH),
                                           raw=True)
        self._others[number] = lambda: self._commands.count_publishers(topic)

    def do_service(self, number: int, name: str, type: str) -> None:
        """Offers a service."""
        kind = type_named(type, "srv")

        async def serve(request: Any, response: Any) -> Any:
            self.look()  # what the caller listens to comes before what it calls, for example sim/unpause
            future = Future(executor=self.node.executor)
            self._last_call += 1
            call = self._last_call
            self._calls[call] = future
            self._channel.send(number, CALL.pack(call) + serialize_message(request))
            data = await future
            return deserialize_message(data, kind.Response)

        def answered(data: bytes) -> None:
            self._finish(self._calls.pop(CALL.unpack_from(data)[0]), data[CALL.size:])
        self._takes[number] = answered
        self.node.create_service(kind, name, serve)

    def do_action(self, number: int, name: str, type: str) -> None:
        """Offers an action."""
        kind = type_named(type, "action")

        async def execute(handle: Any) -> Any:
            future = Future(executor=self.node.executor)
            self._last_call += 1
            call = self._last_call
            self._goals[call] = (handle, future)
            handle.aras_call = call
            self._channel.send(number, CALL.pack(call) + serialize_message(handle.request))
            status, data = await future
            if status == SUCCEEDED:
                handle.succeed()
            elif status == PREEMPTED and handle.is_cancel_requested:
                handle.canceled()
            else:
                handle.abort()
            return deserialize_message(data, kind.Result)

        def cancel(handle: Any) -> CancelResponse:
            self._channel.send(number, CALL.pack(handle.aras_call))
            return CancelResponse.ACCEPT

        def told(data: bytes) -> None:
            call, status = RESULT.unpack_from(data)
            if status:
                self._finish(self._goals.pop(call)[1], (status, data[RESULT.size:]))
            else:
                self._goals[call][0].publish_feedback(deserialize_message(data[RESULT.size:], kind.Feedback))
        self._takes[number] = told
        ActionServer(self.node, kind, name, execute, cancel_callback=cancel)

    def close(self) -> None:
        """Leaves the graph of ROS 2."""
        for node in (self.node, self._commands):
            node.executor.shutdown(timeout_sec=1.0)
            node.destroy_node()
        rclpy.try_shutdown()

    def _finish(self, future, result):
        future.set_result(result)
        self.node.executor.wake()

    # --- to the ROS 1 side ----------------------------------------------------------------------------------------

    def look(self) -> None:
        """Tells the ROS 1 side which topics ROS 2 nodes now listen to or publish on."""
        with self._looking:
            for number, count in list(self._others.items()):
                has = count() > 0
                if has != self._had_others.get(number, False):
                    self._had_others[number] = has
                    self._channel.tell(do="listen", number=number, on=has)

    def look_for_ever(self) -> None:
        """Looks until the process ends."""
        while True:
            time.sleep(LOOK_PERIOD_S)
            self.look()


def main() -> None:
    """Serves until the ROS 1 side ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches both sides; this one ends with the other
    channel = Channel(socket.socket(fileno=int(sys.argv[1])))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    door = Door(channel, socket.socket(fileno=int(sys.argv[2])), sys.argv[3])
    threading.Thread(target=door.look_for_ever, daemon=True).start()
    channel.tell(do="ready")
    code = 0
    try:
        door.read()
    except Exception:
        traceback.print_exc()
        code = 1
    sys.stderr.flush()
    door.close()  # or its shared memory would stay
    os._exit(code)


if __name__ == "__main__":
    main()
