"""A node that works through goals in one ROS graph: each begins with sim/reset, is recorded, and ends with a line.

    goals.py COUNT FOLDER      in a graph of servo.launch with experiment:=false and start_paused:=true

It prints `ready` once the graph stands, then of each goal `goal RUN_HASH TRACE_HASH`: the hash that the simulator gives
of the joint trajectory and of every image, and that of trace.csv, which is made from the bag. The bag is deleted then,
unless the goal has other hashes than the first one of its graph: then both are kept in log/endurance, to be compared.
"""
import hashlib
import os
import shutil
import sys
import tempfile
from pathlib import Path

import rospy
from std_srvs.srv import Empty

from aras_visual_servo_controller.bags.bag import read_bag
from aras_visual_servo_controller.nodes.experiment import ExperimentNode, RunError
from aras_visual_servo_controller.nodes.recording import Recording
from aras_visual_servo_study.report.report import trace_csv

__all__ = ["Goals", "RunError", "end", "hashes"]

KEPT = Path(__file__).resolve().parents[3] / "log" / "endurance"


class Goals(ExperimentNode):
    """The experiment node, which goes on with the next goal instead of writing a report."""

    def __init__(self, folder):
        super().__init__()
        self._folder, self._first = Path(folder), None
        self._subscribe()
        self._reset = rospy.ServiceProxy("sim/reset", Empty)
        self._wait("the nodes", self._missing_parts, self._startup_timeout_s)

    def goal(self):
        """Reset, servo, record. Returns (RunRecord, its `hashes`). Raises what the experiment node raises."""
        self._pause()
        self._reset()
        self._result = self._state = self._done_ns = None
        self._wait("the reset", lambda: [] if self._is_reset() else ["sim/status"], self._startup_timeout_s)
        with tempfile.TemporaryDirectory(dir=self._folder) as folder:
            self._recording = Recording(Path(folder) / "goal.bag", self._topics())
            try:
                self._wait("all connections", self._missing_connections, self._startup_timeout_s)
                self._drive()
            finally:
                self._recording.stop()
            record = read_bag(self._recording.bags(), rospy.get_namespace())
            found = hashes(record)
            self._keep_another(found)
            return record, found

    def _keep_another(self, found):
        """Keep the bag if the hashes of its run are not those of the first goal."""
        [bag], first = self._recording.bags(), self._folder / "first.bag"
        if self._first is None:
            self._first = found
            shutil.copy(bag, first)
        elif found != self._first:
            KEPT.mkdir(parents=True, exist_ok=True)
            for name, path in zip(("first", "other"), (first, bag)):
                shutil.copy(path, KEPT / f"{os.getpid()}_{found[0]}_{name}.bag")

    def _is_reset(self):
        return self._status.paused and self._status.ticks == 0 and not self._status.lockstep_armed


def hashes(record):
    """(run hash, SHA-256 of the trace, shortened to the same length) of a RunRecord."""
    return record.run_hash, hashlib.sha256(trace_csv(record).encode()).hexdigest()[:len(record.run_hash)]


def main():
    """Entry. Returns the exit code."""
    count, folder = int(sys.argv[1]), sys.argv[2]
    rospy.init_node("experiment", disable_signals=True)
    goals = Goals(folder)
    print("ready", flush=True)
    for _ in range(count):
        record, found = goals.goal()
        for note in record.notes:
            print("note", note, flush=True)
        print("goal", *found, flush=True)
    return 0


def end(code):
    """End this process at once: what rospy's threads still do is of no interest."""
    sys.stdout.flush()
    os._exit(code)


if __name__ == "__main__":
    end(main())
