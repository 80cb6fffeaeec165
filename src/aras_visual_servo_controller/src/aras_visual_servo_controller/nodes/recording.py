"""Has the simulator record topics into a bag. It controls images and time, so it can wait for the writer."""

import time
from pathlib import Path
from typing import Any, List

import rospy
from std_srvs.srv import Trigger

from aras_visual_servo import ArasError
from aras_visual_servo_msgs.srv import StartRecording

SETTLED_S = 0.3           # wall time without growth after which nothing is on its way any more
SETTLED_BYTES = 16384     # a bag that grows by less than this in that time gets no more images, only the clock
SETTLE_LIMIT_S = 10.0     # wall time for the other nodes to send their last messages
POLL_S = 0.05             # wall time between looks


class RecordingError(ArasError):
    """The recording could not start or ended by itself; the text says why."""


class Recording:
    """A recording of the simulator of this namespace.

    Args:
        bag: path of the bag, must not exist.  topics: resolved names.  compression: one of COMPRESSIONS.
        split_mb: size after which a new bag begins, NAME_0.bag, NAME_1.bag, ... [MiB]; 0 writes one bag.
    Raises: RecordingError: it cannot start.
    """

    def __init__(self, bag: Path, topics: Any, compression: str = "lz4", split_mb: int = 0) -> None:
        self.bag, self.topics, self._split = Path(bag), list(topics), bool(split_mb)
        start = rospy.ServiceProxy("sim/start_recording", StartRecording)
        answer = start(file=str(self.bag), topics=self.topics, compression=compression, split_mib=split_mb)
        if not answer.success:
            raise RecordingError(answer.message)
        self._running = True

    @staticmethod
    def check(status: Any) -> None:
        """Raises RecordingError if the recording has ended by itself. status: SimStatus."""
        if status.recording_fault:
            raise RecordingError(f"the recording ended: {status.recording_fault}")

    def bags(self) -> List[Path]:
        """Paths of the bags so far in order, the closed ones and the one that is being written."""
        name = f"{self.bag.stem}_*.bag" if self._split else self.bag.name
        found = [path for ending in ("", ".active") for path in self.bag.parent.glob(name + ending)]
        return sorted(found, key=lambda path: (len(path.name.partition(".")[0]), path.name))

    def settle(self) -> None:
        """Let the last messages of other nodes arrive: wait until the bag has all but stopped growing.

        It never stops for good: the paused simulator goes on publishing its clock.
        """
        size, since_s = -SETTLED_BYTES, time.monotonic()
        deadline_s = since_s + SETTLE_LIMIT_S
        while time.monotonic() - since_s < SETTLED_S and time.monotonic() < deadline_s:
            if self._written_bytes() - size >= SETTLED_BYTES:
                size, since_s = self._written_bytes(), time.monotonic()
            time.sleep(POLL_S)

    def _written_bytes(self):
        size = 0
        for path in self.bags():
            try:
                size += path.stat().st_size
            except FileNotFoundError:
                pass  # it was closed and renamed meanwhile
        return size

    def stop(self) -> None:
        """End the recording and wait until the bag is closed. Does no harm if it has ended already.

        Raises: RecordingError: the bag is not whole.
        """
        if not self._running:
            return
        self._running = False
        try:
            answer = rospy.ServiceProxy("sim/stop_recording", Trigger)()
        except rospy.ServiceException as error:  # the simulator is gone, or ends now and closes the bag
            raise RecordingError(f"the simulator does not answer: {error}") from error
        if not answer.success:
            raise RecordingError(f"the recording ended: {answer.message}")
