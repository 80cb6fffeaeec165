"""Lets a `LiveRun` go on, in a thread of its own, at the wanted speed; pages only ever look at it from outside.

Requests wait in a queue until the thread is between two images. What a page sees is a `Sample`, which the thread makes
no more often than pages can show it, and only for viewers: without one a run costs what it costs alone.
"""

import ctypes
import logging
import queue
import threading
import time
from array import array
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

import numpy as np

from aras_visual_servo import ArasError, Status
from .history import MOST_ROWS, packed, thinned
from .page_run import PageRun

#: Wall time between two samples, and between two images [s].
STATE_S, IMAGE_S = 1.0 / 60.0, 1.0 / 30.0
#: Wall time between two rows of a servo that is watched: a fast one takes many images in a short wall time [s].
SERVO_ROW_S = 0.01
#: Wall time after which the real-time factor is measured anew [s].
MEASURED_S = 0.5
#: A run that has fallen this far behind its speed does not catch up [s].
BEHIND_S = 0.1
#: Requests with which simulated time begins anew.
ANEW = ("reset", "lesson", "try_lesson")
#: How many servos are kept with their settings, as many as a page keeps.
MOST_SERVOS = 20
#: Longest that a run sleeps without looking for requests [s].
NAP_S = 0.02
#: Wall time after which code that a page has written is interrupted [s].
HUNG_S = 5.0


class HungCode(ArasError):
    """Code that a page has written does not come back."""

    def __init__(self) -> None:
        super().__init__(f"the code did not come back within {HUNG_S:g} s")


@dataclass(frozen=True)
class Sample:
    """What a page is shown at one moment. It is not changed any more.

    Attributes:
        number: grows by one.  state: dict for JSON.  image: uint8 copy of the last image, or None before the first.
        image_number, marks: of that image.  goal: (number, image, marks, pose) or None.  version: of `about`.
    """

    number: int
    state: dict
    image: Optional[np.ndarray]
    image_number: int
    marks: Optional[dict]
    goal: Any
    version: int


class Runner:
    """The thread. A run whose answers wait for other nodes (`asks_nodes`) gets requests in a second one.

    Args: speed: simulated time per wall time, 0 as fast as possible.
        on_first_viewer: request that is done when the first page looks, or None.
    Attributes:
        sample: the newest `Sample`, None before the first.  rows: (index, `packed` row) of images, the newest last; it
        may be replaced by another list at any time, and grows at its end only.
        servos: (index, message for pages) of each beginning and end of a servo, with the number of its first image and
        the settings there.
        watched: whether a page is ready for news.
        attended: whether a page is open.  about: of the run, made in its thread.
    """

    def __init__(self, run: PageRun, speed: float = 1.0, on_first_viewer: Any = None) -> None:
        self._run, self._speed, self._on_first_viewer = run, speed, on_first_viewer
        self._queue, self._pool = queue.SimpleQueue(), ThreadPoolExecutor(1) if run.asks_nodes else None
        self._beside = ThreadPoolExecutor(1)
        self._paused, self._steps, self._closed = False, 0, False
        self._factor, self._measured = 0.0, None
        self._anchor = None  # (wall [s], simulated [ns]) from which the speed counts
        self._state_s = self._image_s = -1.0
        self._trouble = ""
        self._since_s: Optional[float] = None  # wall time since which code of a page may run [s]
        self._image, self._image_number, self._marks, self._goal = None, 0, None, None
        self._row_at_s, self._row_count, self._row_phase = -1.0, 0, ""
        self.rows: List[Tuple[int, "array[float]"]] = []
        self.servos: Deque[Tuple[int, Dict[str, Any]]] = deque(maxlen=2 * MOST_SERVOS)
        self._servo_image, self._servo_count, self._row_ends = 0, 0, 0
        self.sample, self.watched, self.about = None, False, run.about()
        self.attended = False
        self._thread = threading.Thread(target=self._work, name="live run", daemon=True)

    def start(self) -> None:
        """Begins."""
        self._thread.start()

    def close(self) -> None:
        """Ends the thread and waits for it."""
        self._closed = True
        self._thread.join()
        self._beside.shutdown(cancel_futures=True)

    def urdf_xml(self) -> str:
        """Returns the robot description of the run as it stands: a lesson may have brought another arm."""
        return self._run.scenario.urdf_xml()

    @property
    def edits(self) -> bool:
        """Whether pages may write code that this process runs."""
        return self._run.editor is not None

    def interrupt_hung(self) -> None:
        """Raises `HungCode` in the thread of the run, where code that a page has written does not come back."""
        since_s, ident = self._since_s, self._thread.ident
        if self.edits and since_s is not None and ident is not None and time.perf_counter() - since_s > HUNG_S:
            self._since_s = None
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(ident), ctypes.py_object(HungCode))

    def submit(self, request: Any) -> Future:
        """Returns the future of the answer to a request: dict, or the ArasError that refused it."""
        if self._pool is not None:
            return self._pool.submit(self._do_whole, request)
        answer: Future = Future()
        self._queue.put((request, answer))
        return answer

    # --- the thread ---------------------------------------------------------------------------------------------

    def _work(self):
        while not self._closed:
            try:
                self._run.watched = self.watched
                self._answer_all()
                if self.watched and self._on_first_viewer is not None and self._run.ready:
                    first, self._on_first_viewer = self._on_first_viewer, None
                    self._run.do(first)
                self._go_on()
            except Exception as error:  # the page has to be told, and the arm must not go on by itself
                logging.getLogger(__name__).exception("the run stopped: %s", error)
                self._paused = True
                self._trouble = f"{type(error).__name__}: {error}"

    def _answer_all(self):
        while True:
            try:
                request, answer = self._queue.get_nowait()
            except queue.Empty:
                return
            try:
                result = self._do(request)
                if callable(result):
                    self._beside.submit(_answer, answer, request, result)
                else:
                    answer.set_result(result)
            except RuntimeError as error:  # ours and the simulator's: it names what is wrong
                answer.set_exception(error)
            except Exception as error:
                answer.set_exception(_told(request, error))

    def _do(self, request):
        ours = hasattr(self, "do_" + request.do) and not hasattr(self._run, "do_" + request.do)
        if request.do == "write_law":
            self._since_s = time.perf_counter()
        try:
            result = getattr(self, "do_" + request.do)(request) if ours else self._run.do(request)
        finally:
            self._since_s = None
        names = self.about["rows"]
        if self._told_anew():
            if self.about["rows"] != names or request.do in ANEW or getattr(request, "reset", False):
                self.rows = []
        elif request.do == "set":
            self.about = {**self.about, **self._run.standing()}
        if request.do in ("start", *ANEW):
            self._trouble = ""
        self._state_s = -1.0  # a page sees what came of it at once
        return result or {}

    def _do_whole(self, request):
        result = self._do(request)
        return result() if callable(result) else result

    def _told_anew(self) -> bool:
        """Makes `about` anew if the run has something else to say; returns whether it had."""
        if self.about["version"] == self._run.version:
            return False
        self.about = self._run.about()
        return True

    def do_pause(self, request: Any) -> None:
        """Lets simulated time stand still, or go on."""
        self._paused, self._anchor, self._measured = request.paused, None, None

    def do_step(self, request: Any) -> None:
        """Lets a paused run go on for some images."""
        if not self._paused:
            raise ArasError("step: found a running simulation, allowed when it is paused")
        self._steps += request.images

    def do_speed(self, request: Any) -> None:
        """Sets simulated time per wall time."""
        self._speed, self._anchor = request.factor, None

    def _go_on(self):
        if self._paused and not self._steps:
            self._show()
            time.sleep(NAP_S)
            return
        sim_ns = self._run.time_ns
        wall_s = time.perf_counter()
        if self._anchor is None:
            self._anchor = wall_s, sim_ns
        if self._speed > 0.0 and not self._paused:
            ahead_s = 1e-9 * (sim_ns - self._anchor[1]) / self._speed - (wall_s - self._anchor[0])
            if ahead_s > 1e-4:
                time.sleep(min(ahead_s, NAP_S))
                if ahead_s > NAP_S:
                    return
            elif ahead_s < -BEHIND_S:
                self._anchor = wall_s, sim_ns
        most_ns = round(1e9 * STATE_S * self._speed) if 0.0 < self._speed else 10**12
        self._since_s = time.perf_counter()
        seen = self._run.advance(most_ns)
        self._since_s = None
        if seen:
            self._steps = max(0, self._steps - 1)
            self._note_row()
            self._told_anew()
        self._measure()
        self._show()

    def _measure(self):
        now = time.perf_counter(), self._run.time_ns
        if self._measured is not None and now[1] < self._measured[1]:
            self.rows = []  # the simulator was reset
            self._measured = None
        if self._measured is None:
            self._measured = now
        elif now[0] - self._measured[0] > MEASURED_S:
            self._factor = 1e-9 * (now[1] - self._measured[1]) / (now[0] - self._measured[0])
            self._measured = now

    def _note_row(self):
        wall_s, phase = time.perf_counter(), self._run.phase
        least_s = SERVO_ROW_S if self.attended and phase == "servo" else 0.9 * IMAGE_S
        # The first and the last image of a servo are moments that the time line marks.
        ends = self._run.aftermath.ends
        turned, self._row_ends = phase != self._row_phase or ends > self._row_ends, ends
        if turned:
            self._note_servo(phase)
        if self._paused or turned or wall_s - self._row_at_s >= least_s:
            self._row_at_s, self._row_phase = wall_s, phase
            self.rows.append((self._row_count, packed(self._run.row(self._factor))))
            self._row_count += 1
            if len(self.rows) > MOST_ROWS:
                self.rows = thinned(self.rows, lambda entry: entry[0])  # a new list: pages may be reading the old one

    def _note_servo(self, phase: str) -> None:
        """Notes the settings with which a servo began or ended. One that ends with its first image does both."""
        begins, ends = phase == "servo" or phase == "done" and self._row_phase != "servo", phase == "done"
        if begins:
            self._servo_image = self._run.images
        for key in ["values"] * begins + ["after"] * ends:
            message = {"type": "servo", "image": self._servo_image, key: self._run.used.as_dict()}
            self.servos.append((self._servo_count, message))
            self._servo_count += 1

    def _show(self):
        """Make a new sample if there are viewers and it is time for one."""
        run, wall_s = self._run, time.perf_counter()
        if not self.watched or wall_s - self._state_s < 0.9 * STATE_S or run.joints() is None:
            return
        standing = self._paused and not self._steps
        if standing and self._state_s > 0.0 and wall_s - self._state_s < 0.5:
            return  # nothing has moved
        self._state_s = wall_s
        if run.image is not None and run.images != self._image_number and wall_s - self._image_s >= 0.9 * IMAGE_S:
            self._image_s = wall_s
            self._image, self._marks, self._image_number = np.array(run.image), run.marks(), run.images
        if run.goal is None:
            self._goal = None
        elif self._goal is None or self._goal[1] is not run.goal[0]:
            self._goal = (self._image_number, *run.goal)
        state: Dict[str, Any] = {"paused": self._paused, "speed": self._speed, "factor": round(self._factor, 3),
                                 **run.state()}
        if self._trouble:
            state.update(run.why(Status.FAULT, self._trouble))
        number = 0 if self.sample is None else self.sample.number + 1
        self.sample = Sample(number, state, self._image, self._image_number, self._marks, self._goal, run.version)


def _answer(answer: Future, request: Any, work: Callable[[], Dict[str, Any]]) -> None:
    """Does work that takes long, beside the run."""
    try:
        answer.set_result(work())
    except RuntimeError as error:
        answer.set_exception(error)
    except Exception as error:
        answer.set_exception(_told(request, error))


def _told(request: Any, error: Exception) -> ArasError:
    """The error that a page is told, and a line in the log with where it came from."""
    logging.getLogger(__name__).error("request %s", request, exc_info=error)
    return ArasError(f"{request.do}: {type(error).__name__}: {error}")
