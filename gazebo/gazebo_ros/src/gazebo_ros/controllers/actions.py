"""Base class of controllers with an action: one goal at a time, and a server that survives a time reset."""
import typing

import actionlib

from .adapter import Adapter

NOT_RUNNING = "Can't accept new action goals. Controller is not running."


class ActionAdapter(Adapter):
    """Adapter of a controller whose goals come through one action. A subclass takes them in `accept`."""

    _goal = None

    def serve(self, name: str, kind: typing.Any) -> None:
        """Opens the action of this name and kind."""
        self._action = name, kind
        self._open_action()
        self.ends_with(lambda: self._server.stop())

    def accept(self, handle: typing.Any) -> None:
        """Takes a goal by `take`, or rejects it."""
        raise NotImplementedError

    def take(self, handle: typing.Any) -> None:
        """The goal goes on from now on, in the place of the one before."""
        self.finish("canceled")
        handle.set_accepted()
        self._goal = handle

    def finish(self, end: str, *result: typing.Any) -> None:
        """Ends the goal that there is: "succeeded", "aborted" or "canceled"."""
        goal, self._goal = self._goal, None
        if goal is not None:
            getattr(goal, "set_" + end)(*result)

    def time_reset(self, now_ns: int) -> None:
        """An action server takes no goals that are older than those it has seen: a new one is needed."""
        self.finish("canceled")
        self._server.stop()
        self._open_action()
        super().time_reset(now_ns)

    def _open_action(self) -> None:
        # Its callbacks hold a lock that answering takes too: they leave the work to the world's thread.
        name, kind = self._action
        self._server = actionlib.ActionServer(self.topic(name), kind,
                                              lambda goal: self.work.post(lambda: self.accept(goal)),
                                              lambda goal: self.work.post(lambda: self._cancel(goal)), auto_start=False)
        self._server.start()

    def _cancel(self, handle: typing.Any) -> None:
        if self._goal is not None and handle == self._goal:
            if self.running:
                self.simulation.cancel_goal(self.name)
            self.finish("canceled")
