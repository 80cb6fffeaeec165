"""Queue of calls from other threads, which the world's thread runs between two steps."""
import concurrent.futures
import queue
import time
import typing

import rospy

LIMIT_S = 60.0  #: wall time after which a caller gives up on the world


class WorldGoneError(Exception):
    """The world ended before it answered."""


class Work:
    """A queue of calls. Callbacks of rospy run in threads of their own; the world is touched by one thread alone."""

    def __init__(self) -> None:
        self._queue, self._closed = queue.Queue(), False

    def post(self, action: typing.Callable[[], typing.Any], name: str = "") -> None:
        """Schedules action(). Discards its result, and logs its exceptions under this name."""
        self._queue.put((action, name, None))

    def call(self, action: typing.Callable[[], typing.Any]) -> typing.Any:
        """Calls action() in the world's thread and waits. Returns its result and raises its exceptions."""
        answer = concurrent.futures.Future()
        self._queue.put((action, "", answer))
        end_s = time.monotonic() + LIMIT_S
        while not concurrent.futures.wait([answer], timeout=0.1).done:
            if self._closed or time.monotonic() > end_s:
                raise WorldGoneError("the world does not answer any more")
        return answer.result()

    def run(self, wait_s: float) -> None:
        """Does all that is there; when there is nothing, waits up to this wall time for the first."""
        try:
            item = self._queue.get(wait_s > 0.0, max(wait_s, 1e-6))
            while True:
                self._do(*item)
                item = self._queue.get_nowait()
        except queue.Empty:
            pass

    @staticmethod
    def _do(action: typing.Callable[[], typing.Any], name: str,
            answer: typing.Optional[concurrent.futures.Future]) -> None:
        try:
            value = action()
            if answer is not None:
                answer.set_result(value)
        except Exception as error:  # goes to the caller or to the log; the world goes on
            if answer is not None:
                answer.set_exception(error)
            else:
                rospy.logerr("%s: %s" % (name or type(error).__name__, error))

    def close(self) -> None:
        self._closed = True
