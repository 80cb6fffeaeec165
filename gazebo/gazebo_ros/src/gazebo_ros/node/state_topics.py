"""The topics /gazebo/model_states and link_states, while somebody listens; /gazebo/set_model_state."""
from gazebo_msgs.msg import LinkStates, ModelState, ModelStates
from geometry_msgs.msg import Pose, Twist

from .convert import pose_message, twist_message
from .outlet import Outlet


class StateTopics(Outlet):
    rate_hz = 100.0  # Gazebo sends them at every step

    def __init__(self, server, services):
        self._server = server
        super().__init__(server.world, None, server.work)
        self._models = self.advertise("/gazebo/model_states", ModelStates)
        self._links = self.advertise("/gazebo/link_states", LinkStates)
        self.listen("/gazebo/set_model_state", ModelState, services.place)
        self.begin(0)

    def send(self, _now_ns):
        models = self.world.models
        if self._models.get_num_connections():
            ground = self._server.model_names()[:len(self._server.model_names()) - len(models)]
            self._models.publish(ModelStates(
                name=self._server.model_names(),
                pose=[still()] * len(ground) + [pose_message(each.pose()) for each in models.values()],
                twist=[Twist()] * len(ground) + [twist_message(each.twist()) for each in models.values()]))
        if self._links.get_num_connections():
            links = [(model, link) for model in models.values() for link in model.links]
            self._links.publish(LinkStates(name=["%s::%s" % (model.name, link) for model, link in links],
                                           pose=[pose_message(model.link_pose(link)) for model, link in links],
                                           twist=[twist_message(model.link_twist(link)) for model, link in links]))


def still():
    pose = Pose()
    pose.orientation.w = 1.0
    return pose
