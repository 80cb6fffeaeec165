"""The topics /gazebo/model_states and link_states, while they have subscribers; /gazebo/set_model_state."""
import typing

from gazebo_msgs.msg import LinkStates, ModelState, ModelStates
from geometry_msgs.msg import Pose, Twist

from ..sdf.world import GROUND
from .convert import pose_message, twist_message
from .outlet import Outlet

if typing.TYPE_CHECKING:
    from .server import Server
    from .services.world_services import WorldServices

GROUND_LINK = "link"  #: of the model ground_plane


class StateTopics(Outlet):
    rate_hz = 100.0  # Gazebo sends them at every step

    def __init__(self, server: "Server", services: "WorldServices") -> None:
        self._server = server
        super().__init__(server.world, None, server.work)
        self._models = self.advertise("/gazebo/model_states", ModelStates)
        self._links = self.advertise("/gazebo/link_states", LinkStates)
        self.listen("/gazebo/set_model_state", ModelState, services.place)
        self.begin(0)

    def send(self, _now_ns: int) -> None:
        """As publishModelStates and publishLinkStates of gazebo_ros_api_plugin.cpp: models as the world counts them,
        links as each model has them."""
        models, names = self.world.models, self.world.names
        if self._models.get_num_connections():
            self._models.publish(ModelStates(
                name=names, pose=[pose_message(models[name].pose()) if name in models else still() for name in names],
                twist=[twist_message(models[name].twist()) if name in models else Twist() for name in names]))
        if self._links.get_num_connections():
            links = [(models.get(name), link) for name in names
                     for link in (models[name].bodies if name in models else [GROUND_LINK])]
            self._links.publish(LinkStates(
                name=["%s::%s" % (model.name if model else GROUND, link) for model, link in links],
                pose=[pose_message(model.link_pose(link)) if model else still() for model, link in links],
                twist=[twist_message(model.link_twist(link)) if model else Twist() for model, link in links]))


def still() -> Pose:
    pose = Pose()
    pose.orientation.w = 1.0
    return pose
