"""The services /gazebo/save_state and restore_state: the whole world, as sim/save_state and sim/restore_state of one
robot have it."""
import itertools
import pathlib
import typing

from aras_visual_servo_msgs.srv import RestoreState, SaveState

from aras_visual_servo_sim import ParameterError

from ...world import snapshot
from .serve import Services

MOST = 100  #: states that are kept


class StateServices(Services):
    def offer(self) -> None:
        self._kept, self._numbers = {}, itertools.count(1)
        self.serve("save_state", SaveState, self._save)
        self.serve("restore_state", RestoreState, lambda request: self.server.restore(self._found(request)))

    def _save(self, request: typing.Any) -> typing.Dict[str, typing.Any]:
        name, state = request.name or "state_%d" % next(self._numbers), snapshot.saved(self.world)
        if name not in self._kept and len(self._kept) >= MOST:
            raise ParameterError("save_state: found %d states that are kept, allowed are up to %d" %
                                 (len(self._kept), MOST))
        if request.file:
            pathlib.Path(request.file).write_bytes(state)
        self._kept[name] = state
        return {"message": "state of %.3f s" % (1e-9 * self.world.time_ns), "name": name}

    def _found(self, request: typing.Any) -> bytes:
        """bytes. Raises: ParameterError, OSError."""
        if bool(request.name) == bool(request.file):
            raise ParameterError("restore_state: found %s of name and file, allowed one of them" %
                                 ("both" if request.name else "neither"))
        if request.file:
            return pathlib.Path(request.file).read_bytes()
        if request.name not in self._kept:
            raise ParameterError("restore_state: found name '%s', allowed: %s" %
                                 (request.name, ", ".join(self._kept) or "none was saved"))
        return self._kept[request.name]
