"""Runs as an MCAP file.

Of bags every message is copied as it is, with the text of its ROS 1 type. Of other runs there is one JSON message per
image on NAME/servo: stamp, phase, status, features, errors, twist, joint positions, true camera pose.
"""

import json
from pathlib import Path
from typing import Any, Union

import numpy as np

from aras_visual_servo import TWIST_NAMES, RunRecord, Status, extra

_NUMBERS = {"type": "object", "additionalProperties": {"type": ["number", "null"]}}
SCHEMA = {"title": "aras_visual_servo/Servo", "type": "object", "properties": {
    "stamp_ns": {"type": "integer"}, "phase": {"type": "string"}, "status": {"type": "string"},
    "features": _NUMBERS, "feature_errors": _NUMBERS, "twist": _NUMBERS, "joint_positions": _NUMBERS,
    "camera_pose_world": {"type": "array", "items": {"type": "array", "items": {"type": ["number", "null"]}}}}}


class McapFile:
    """Context in which an MCAP file is written. Raises MissingExtra: there is no mcap."""

    def __init__(self, path: Union[str, Path]):
        self._library, self._path = extra("mcap.writer", "writing MCAP"), path
        self._channels, self._json = {}, None
        self.messages = 0

    def __enter__(self) -> "McapFile":
        self._stream = open(self._path, "wb")
        self._writer = self._library.Writer(self._stream)
        self._writer.start(profile="", library="aras_visual_servo")
        return self

    def __exit__(self, *_: Any) -> None:
        self._writer.finish()
        self._stream.close()

    def add_bags(self, paths: str) -> None:
        """Copy every message of a bag, or of a folder of bags."""
        from aras_visual_servo_controller import BagFiles
        with BagFiles(paths) as bags:
            for topic, message, time in bags.raw_messages():
                kind, data, _, _, python = message
                if topic not in self._channels:
                    schema = self._writer.register_schema(kind, "ros1msg", python._full_text.encode())
                    self._channels[topic] = self._writer.register_channel(topic, "ros1", schema)
                self._add(self._channels[topic], time.to_nsec(), data)

    def add_record(self, name: str, record: RunRecord) -> None:
        """Add one message for each image of a run."""
        if self._json is None:
            self._json = self._writer.register_schema(SCHEMA["title"], "jsonschema", json.dumps(SCHEMA).encode())
        channel = self._writer.register_channel(f"{name}/servo", "json", self._json)
        for row, stamp_ns in enumerate(record.stamp_ns.tolist()):
            self._add(channel, stamp_ns, json.dumps({
                "stamp_ns": stamp_ns, "phase": str(record.phase[row]), "status": Status(record.status[row]).name,
                "features": _named(record.feature_names, record.s[row]),
                "feature_errors": _named(record.feature_names, record.e[row]),
                "twist": _named(TWIST_NAMES, record.twist[row]),
                "joint_positions": _named(record.joint_names, record.q[row]),
                "camera_pose_world": [[_number(x) for x in line] for line in record.X_WC[row]]}).encode())

    def _add(self, channel, time_ns, data):
        self._writer.add_message(channel, time_ns, data, time_ns)
        self.messages += 1


def _named(names, values):
    return {name: _number(value) for name, value in zip(names, values)}


def _number(value):
    """JSON knows no NaN."""
    return float(value) if np.isfinite(value) else None
