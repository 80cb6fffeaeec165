"""The topics /gazebo/model_states and link_states, while somebody listens; /gazebo/set_model_state."""
import rospy
from gazebo_msgs.msg import LinkStates, ModelState, ModelStates
from geometry_msgs.msg import Pose, Twist

from aras_visual_servo_sim import ArasError

from ..world.errors import GazeboError
from .beat import NEVER_NS, Beat
from .convert import pose_message, twist_message

RATE_HZ = 100.0  #: Gazebo sends them at every step


class StateTopics:
    def __init__(self, server, services):
        self._server, self._services = server, services
        self._models = rospy.Publisher("/gazebo/model_states", ModelStates, queue_size=10)
        self._links = rospy.Publisher("/gazebo/link_states", LinkStates, queue_size=10)
        self._beat = Beat(RATE_HZ, 0)
        rospy.Subscriber("/gazebo/set_model_state", ModelState,
                         lambda message: server.work.post(lambda: self._place(message)))

    def _place(self, message):
        try:
            self._services.place(message)
        except (GazeboError, ArasError) as error:
            rospy.logerr("set_model_state: %s" % error)

    def _wanted(self):
        return self._models.get_num_connections() or self._links.get_num_connections()

    @property
    def next_ns(self):
        return self._beat.next_ns if self._wanted() else NEVER_NS

    def time_reset(self, now_ns):
        self._beat = Beat(RATE_HZ, now_ns)

    def publish(self, now_ns):
        if not self._beat.due(now_ns):
            return
        models = self._server.world.models
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
