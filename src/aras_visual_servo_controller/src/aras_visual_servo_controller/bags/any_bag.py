"""Reads the messages of ROS 1 bags, and through the library rosbags those of rosbag2 and MCAP, in one form."""

from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, Tuple

from aras_visual_servo import extra
from .files import MAGIC, NAMES, BagError, BagFiles


class AnyBag:
    """Context in which a bag is open: a file .bag, .mcap or .db3, or a folder of ROS 1 bags or of a rosbag2.

    Attributes: name: of the bag, for messages.  notes: texts about joined and repaired parts.
    Raises: BagError: there is no such file, or it cannot be read.  MissingExtra: rosbags is not installed.
    """

    def __init__(self, path: str) -> None:
        self.name = path
        self._files = BagFiles(path) if _is_ros1(Path(path)) else None
        self._reader: Any = None
        if self._files is None and not Path(path).exists():
            raise BagError(f"bag '{path}': no such file")

    def __enter__(self) -> "AnyBag":
        if self._files is not None:
            self._files.__enter__()
            return self
        reader = extra("rosbags.highlevel", f"reading {self.name}")
        stores = extra("rosbags.typesys", f"reading {self.name}")
        try:
            # Files of rosbag2 before ROS 2 Iron hold no definitions of the messages.
            self._reader = reader.AnyReader([Path(self.name)],
                                            default_typestore=stores.get_typestore(stores.Stores.ROS2_HUMBLE))
            self._reader.open()
        except Exception as error:  # errors of the library, of sqlite, yaml and zstandard
            raise BagError(f"bag '{self.name}': cannot be read: {error}") from error
        return self

    def __exit__(self, *_: Any) -> None:
        if self._files is not None:
            self._files.__exit__()
        elif self._reader is not None:
            self._reader.close()

    @property
    def notes(self) -> Tuple[str, ...]:
        """Returns texts about joined and repaired parts."""
        return () if self._files is None else tuple(self._files.notes)

    @property
    def types(self) -> Dict[str, str]:
        """Topic -> type of its messages as ROS 1 writes it, e.g. sensor_msgs/JointState."""
        if self._files is not None:
            return self._files.types
        return {topic: str(info.msgtype).replace("/msg/", "/") for topic, info in self._reader.topics.items()}

    def count(self, topic: str) -> int:
        """Returns the number of messages of a topic."""
        return self._files.count(topic) if self._files is not None else self._reader.topics[topic].msgcount

    def messages(self, topics: Iterable[str]) -> Iterator[Tuple[str, Any, float]]:
        """(topic, message, when the recorder got it [s]) of these topics in order."""
        chosen = set(topics)
        if self._files is not None:
            yield from self._files.received(chosen)
            return
        connections = [each for each in self._reader.connections if each.topic in chosen]
        for connection, at_ns, data in self._reader.messages(connections=connections) if connections else ():
            try:
                yield connection.topic, self._reader.deserialize(data, connection.msgtype), at_ns * 1e-9
            except Exception as error:  # a message that was cut, or of another definition
                raise BagError(f"bag '{self.name}': {connection.topic}: cannot be read: {error}") from error


def stamp_s(message: Any) -> float:
    """Returns the stamp of a message's header [s]; of ROS 1 and ROS 2."""
    stamp = message.header.stamp
    return duration_s(stamp)


def duration_s(time: Any) -> float:
    """Returns a time or duration of ROS 1 or ROS 2 in seconds."""
    return float(time.to_sec()) if hasattr(time, "to_sec") else time.sec + 1e-9 * time.nanosec


def _is_ros1(path):
    if path.is_dir():
        return any(True for pattern in NAMES for _ in path.glob(pattern)) and not (path / "metadata.yaml").exists()
    if not path.exists():
        return path.suffix not in (".mcap", ".db3")  # BagFiles reports the missing file
    with open(path, "rb") as stream:
        return stream.read(len(MAGIC)) == MAGIC
