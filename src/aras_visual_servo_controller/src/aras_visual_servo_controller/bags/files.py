"""Finds the bags of a run, opens them (a damaged one is repaired on a copy) and reads them as one. Needs no ROS master.

A run may be in one bag, in the parts that `rosbag record --split` made (run_0.bag, run_1.bag, ...), in bags of several
recorders, or in what a process left that was killed while it recorded (run.bag.active).
"""

import os
import re
import shutil
import tempfile
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Set, Tuple

from aras_visual_servo import ArasError

MAGIC = b"#ROSBAG V2.0"
HEADER_BYTES = 4096          # the file header record is padded to this
PART = re.compile(r"(.+)_(\d+)\.bag(?:\.active)?$")
NAMES = ("*.bag", "*.bag.active")


class BagError(ArasError):
    """A bag cannot be read, or lacks data of a record."""


class BagFiles:
    """Context in which the bags of a run are open, in the order of time.

    Args: paths: of a bag, of a folder of bags, or a list of bags. One part of a split bag stands for all of it.
    Attributes: name: of the run, for messages.  notes: texts about joined and repaired parts.
    Raises: BagError: a file is missing, is no bag, or cannot be repaired.
    """

    def __init__(self, paths: Any) -> None:
        paths = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
        self._paths, self.notes = find_bags(paths)
        self.name = ", ".join(str(path) for path in paths)
        self._bags, self._folders = [], []

    def __enter__(self) -> "BagFiles":
        try:
            self._bags = [self._open(path) for path in self._paths]
        except BaseException:
            self.__exit__()
            raise
        self._bags.sort(key=_start)  # bags that begin at the same time keep the given order
        return self

    def __exit__(self, *_: Any) -> None:
        for bag in self._bags:
            bag.close()
        for folder in self._folders:
            shutil.rmtree(folder, ignore_errors=True)

    @property
    def topics(self) -> Set[str]:
        """Names of all topics, a set."""
        return set(self.types)

    @property
    def types(self) -> Dict[str, str]:
        """Topic -> type of its messages."""
        return {topic: info.msg_type for bag in self._bags for topic, info in
                bag.get_type_and_topic_info().topics.items()}

    def count(self, topic: str) -> int:
        """Number of messages of a topic, as the indices of the bags tell."""
        infos = (bag.get_type_and_topic_info([topic]).topics.get(topic) for bag in self._bags)
        return sum(info.message_count for info in infos if info is not None)

    def messages(self, topics: Iterable[str]) -> Iterator[Tuple[str, Any]]:
        """(topic, message) of these topics in order. A broken bag ends early, with a note."""
        for topic, message, _ in self.received(topics):
            yield topic, message

    def received(self, topics: Iterable[str]) -> Iterator[Tuple[str, Any, float]]:
        """(topic, message, arrival [s]) of these topics in order. A broken bag ends early, with a note."""
        for bag in self._bags:
            try:
                for topic, message, at in bag.read_messages(topics=list(topics)):
                    yield topic, message, at.to_sec()
            except Exception as error:  # a chunk cut in two: struct.error, roslz4 and bz2 errors, ROSBagFormatException
                note = f"the bag is broken and was read up to there: {error}"
                if note not in self.notes:
                    self.notes.append(note)

    def raw_messages(self) -> Iterator[Any]:
        """Yield (topic, (type, bytes, MD5, position, Python class), time) of all messages, undecoded, bag after bag."""
        for bag in self._bags:
            yield from bag.read_messages(raw=True)

    def _open(self, path):
        import rosbag  # only here, so that the rest of the package works without ROS
        try:
            return rosbag.Bag(str(path))
        except Exception as error:  # struct.error, ROSBagException and others: no bag at all, or one that was cut
            reason = error
        if not _is_bag(path):
            raise BagError(f"bag '{path}': cannot be read: {reason}") from reason
        folder = tempfile.mkdtemp(prefix="aras_bag_")
        self._folders.append(folder)
        copy = os.path.join(folder, "copy.bag")
        try:
            shutil.copyfile(path, copy)
            _forget_index(copy)
            with rosbag.Bag(copy, "a", allow_unindexed=True) as bag:
                for _ in bag.reindex():
                    pass
            bag = rosbag.Bag(copy)
        except Exception as error:
            raise BagError(f"bag '{path}': was not closed and cannot be repaired: {error}") from error
        self.notes.append(f"the bag {path.name} was not closed, or was cut: a copy was indexed anew and read as far as "
                          "it goes")
        return bag


def find_bags(paths: Any) -> Tuple[List[Path], List[str]]:
    """(files, notes) of a run: list of Path, and list of texts about joined and missing parts.

    Args: paths: list of bags and folders.
    Raises: BagError: a file does not exist, or a folder holds no bag.
    """
    found, notes = [], []
    for path in map(Path, paths):
        if path.is_dir():
            inside = sorted((p for pattern in NAMES for p in path.glob(pattern)), key=_number)
            if not inside:
                raise BagError(f"folder '{path}': holds no bag (*.bag, *.bag.active)")
            found += inside
        elif not path.is_file():
            beside = path.with_name(path.name + ".active")
            split = _parts(path.with_name(path.stem + "_0.bag"))
            hint = f"; there is {beside.name}, left by a recorder that was killed" if beside.is_file() else \
                f"; there are {', '.join(p.name for p in split)}, of a split recording" if split else ""
            raise BagError(f"bag '{path}': no such file{hint}")
        else:
            found.append(path)
    if len(paths) == 1 and len(found) == 1:
        parts = _parts(found[0])
        if len(parts) > 1 and _follow_each_other(parts):
            found = parts
            notes.append("read as one run: " + ", ".join(part.name for part in parts))
    numbers = [int(match.group(2)) for match in (PART.match(path.name) for path in found) if match]
    missing = sorted(set(range(max(numbers, default=-1) + 1)) - set(numbers)) if len(numbers) == len(found) else []
    if missing:
        notes.append("parts of the split bag are missing: " + ", ".join(map(str, missing)))
    return list(dict.fromkeys(found)), notes


def _parts(path):
    """All parts, in order, of the split bag that `path` is a part of; [] if it is not part of one."""
    match = PART.match(path.name)
    if not match:
        return []
    parts = [other for other in path.parent.iterdir() if (found := PART.match(other.name))
             and found.group(1) == match.group(1)]
    return sorted(parts, key=_number)


def _follow_each_other(parts):
    """Whether each part begins after the one before has ended. Bags of other runs with similar names do not."""
    import rosbag
    end = -1.0
    for part in parts:
        try:
            with rosbag.Bag(str(part)) as bag:
                if bag.get_message_count() == 0:
                    continue
                if bag.get_start_time() < end:
                    return False
                end = bag.get_end_time()
        except Exception:  # a part that was not closed can only be the last one
            return part == parts[-1]
    return True


def _number(path):
    match = PART.match(path.name)
    return (match.group(1), int(match.group(2))) if match else (path.name, -1)


def _start(bag):
    return bag.get_start_time() if bag.get_message_count() else float("inf")


def _is_bag(path):
    with open(path, "rb") as stream:
        return stream.read(len(MAGIC)) == MAGIC


def _forget_index(path):
    """Set the place of the index in the header to 0. In a bag that was cut it lies behind the end of the file."""
    with open(path, "r+b") as stream:
        at = stream.read(HEADER_BYTES).find(b"index_pos=")
        if at >= 0:
            stream.seek(at + len(b"index_pos="))
            stream.write(bytes(8))
