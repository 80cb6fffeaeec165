"""What other threads want of the world, done by the thread that owns it, between two steps."""
import queue
import threading

import rospy

LIMIT_S = 60.0  #: wall time after which a caller gives up on the world


class WorldGoneError(Exception):
    """The world ended before it answered."""


class Work:
    """A queue of calls. Callbacks of rospy run in threads of their own; the world is touched by one thread alone."""

    def __init__(self):
        self._queue = queue.Queue()
        self._closed = threading.Event()

    def post(self, action, name=""):
        """Lets action() be called soon; what it returns is lost, and what it raises is logged under this name."""
        self._queue.put((action, None, name))

    def call(self, action):
        """Calls action() in the world's thread and waits. Returns what it returns, raises what it raises."""
        answer = queue.Queue(1)
        self._queue.put((action, answer, ""))
        for _ in range(int(10 * LIMIT_S)):
            try:
                value, error = answer.get(timeout=0.1)
            except queue.Empty:
                if self._closed.is_set():
                    break
                continue
            if error is not None:
                raise error
            return value
        raise WorldGoneError("the world does not answer any more")

    def run(self, wait_s):
        """Does all that is there; when there is nothing, waits up to this wall time for the first."""
        try:
            item = self._queue.get(wait_s > 0.0, max(wait_s, 1e-6))
            while True:
                self._do(*item)
                item = self._queue.get_nowait()
        except queue.Empty:
            pass

    @staticmethod
    def _do(action, answer, name):
        value, error = None, None
        try:
            value = action()
        except Exception as caught:  # goes to who asked, or to the log: the world goes on
            error = caught
        if answer is not None:
            answer.put((value, error))
        elif error is not None:
            rospy.logerr("%s: %s" % (name or type(error).__name__, error))

    def close(self):
        self._closed.set()
