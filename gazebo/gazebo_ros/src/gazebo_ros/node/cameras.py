"""Images of the cameras of one model, under the names that their tags give."""
import rospy
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Empty

from aras_visual_servo_sim import ArasError

from .beat import NEVER_NS
from .convert import stamp


class Cameras:
    """Sends each image when it is due, while somebody listens.

    Attributes:
        sent_ns: time of the last image that somebody listened to, int [ns]; -1: there was none.
    """

    def __init__(self, world, model, work):
        self._world, self._model = world, model
        self._topics, self._subscribers, self.sent_ns = {}, [], -1
        for name, topics in model.description.cameras.items():
            if name not in model.simulation.camera_names:
                continue
            self._topics[name] = (rospy.Publisher(topics.image, Image, queue_size=4),
                                  rospy.Publisher(topics.info, CameraInfo, queue_size=4))
            self._subscribers.append(rospy.Subscriber(topics.trigger, Empty, lambda _, camera=name: work.post(
                lambda: self._model.simulation.trigger(camera))))

    @property
    def next_ns(self):
        times = [self._model.simulation.next_image_ns(name) for name in self._topics]
        return min((self._model.begun_ns + time for time in times if time < NEVER_NS), default=NEVER_NS)

    def publish(self, now_ns):
        """To be called at every stop of the world."""
        simulation = self._model.simulation
        for name, (images, infos) in self._topics.items():
            if self._model.begun_ns + min(simulation.next_image_ns(name), NEVER_NS) != now_ns:
                continue
            simulation.step_to_image(name)  # takes the frame of this very tick
            if not images.get_num_connections() and not infos.get_num_connections():
                continue
            info = simulation.camera_info(name)
            message = CameraInfo(width=info["width"], height=info["height"], D=info["D"], K=info["K"], R=info["R"],
                                 P=info["P"], distortion_model=info["distortion_model"])
            message.header.stamp, message.header.frame_id = stamp(now_ns), info["frame_id"]
            infos.publish(message)
            if images.get_num_connections():
                self._send(name, images, message.header)

    def _send(self, name, images, header):
        self._world.look(self._model)
        try:
            image = self._model.simulation.render(name)
        except ArasError as error:
            rospy.logerr_throttle(10.0, "camera '%s' of model '%s': %s" % (name, self._model.name, error))
            return
        self.sent_ns = self._world.time_ns
        encoding = self._model.simulation.camera_encoding(name)
        images.publish(Image(header=header, height=image.shape[0], width=image.shape[1], encoding=encoding,
                             step=image.strides[0], data=image.tobytes()))

    def time_reset(self, _now_ns):
        self.sent_ns = -1

    def close(self):
        for publishers in self._topics.values():
            for publisher in publishers:
                publisher.unregister()
        for subscriber in self._subscribers:
            subscriber.unregister()
