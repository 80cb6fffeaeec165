"""The services /gazebo/save_state and restore_state: the whole world, as sim/save_state and sim/restore_state of one
robot have it."""
import rospy
from aras_visual_servo_msgs.srv import RestoreState, RestoreStateResponse, SaveState, SaveStateResponse

from aras_visual_servo_sim import ArasError

from ...world import snapshot
from ...world.errors import BadValueError, GazeboError
from ..convert import stamp

MOST = 100  #: states that are kept


class StateServices:
    def __init__(self, server, in_turn):
        """
        Args:
            server: Server.  in_turn: of GazeboServices.
        """
        self._server, self._kept, self._count = server, {}, 0
        rospy.Service("/gazebo/save_state", SaveState, in_turn(self._save))
        rospy.Service("/gazebo/restore_state", RestoreState, in_turn(self._restore))

    def _save(self, request):
        try:
            name, state = request.name or self._next_name(), snapshot.saved(self._server.world)
            if name not in self._kept and len(self._kept) >= MOST:
                raise BadValueError("save_state: found %d states that are kept, allowed are up to %d" %
                                    (len(self._kept), MOST))
            if request.file:
                with open(request.file, "wb") as file:
                    file.write(state)
            self._kept[name] = state
            return SaveStateResponse(True, "state of %.3f s" % (1e-9 * self._server.world.time_ns), name)
        except (GazeboError, ArasError, OSError) as error:
            rospy.logerr("save_state: %s" % error)
            return SaveStateResponse(False, str(error), "")

    def _next_name(self):
        self._count += 1
        return "state_%d" % self._count

    def _restore(self, request):
        response = RestoreStateResponse(success=True)
        try:
            self._server.restore(self._found(request))
        except (GazeboError, ArasError, OSError) as error:
            rospy.logerr("restore_state: %s" % error)
            response = RestoreStateResponse(success=False, message=str(error))
        response.stamp = stamp(self._server.world.time_ns)
        return response

    def _found(self, request):
        """bytes. Raises: BadValueError, OSError."""
        if bool(request.name) == bool(request.file):
            raise BadValueError("restore_state: found %s of name and file, allowed one of them" %
                                ("both" if request.name else "neither"))
        if request.file:
            with open(request.file, "rb") as file:
                return file.read()
        if request.name not in self._kept:
            raise BadValueError("restore_state: found name '%s', allowed: %s" %
                                (request.name, ", ".join(self._kept) or "none was saved"))
        return self._kept[request.name]
