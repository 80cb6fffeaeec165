"""Images, depth and points of the cameras of one model, under the names that their tags give."""
import os
import struct
import typing

import numpy
import rospy
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from std_msgs.msg import Empty, Header

from aras_visual_servo_sim import ArasError

from .convert import stamped
from .outlet import NEVER_NS, Outlet

#: Pixels of an image that several threads draw faster than one. Smaller ones are then drawn in as many, too.
LARGE_PX = 150000


class ArrayImage(Image):
    """A sensor_msgs/Image whose pixels stay in their array, `array`, and are copied once, when it is sent."""

    array: numpy.ndarray

    def serialize(self, buff: typing.BinaryIO) -> None:
        super().serialize(buff)  # with no data, which are the last of its fields
        buff.seek(-4, os.SEEK_CUR)
        buff.write(struct.pack("<I", self.array.nbytes))
        buff.write(self.array)


def image_message(header: Header, image: numpy.ndarray, encoding: str) -> Image:
    """Args: image: (h, w) or (h, w, channels), which does not change until the message is published."""
    array = numpy.ascontiguousarray(image)
    message = ArrayImage(header=header, height=array.shape[0], width=array.shape[1], encoding=encoding,
                         step=array.strides[0])
    message.array = array
    return message


def cloud_message(header: Header, points: numpy.ndarray) -> PointCloud2:
    """A sensor_msgs/PointCloud2 of points (h, w, 4) float32: x, y, z, rgb."""
    fields = [PointField(name=name, offset=4 * k, datatype=PointField.FLOAT32, count=1)
              for k, name in enumerate(("x", "y", "z", "rgb"))]
    return PointCloud2(header=header, height=points.shape[0], width=points.shape[1], fields=fields, point_step=16,
                       row_step=16 * points.shape[1], data=points.tobytes(), is_dense=False)


class Cameras(Outlet):
    """Publishes each image when it is due, while it has subscribers. The server renders all models together.

    Attributes: sent_ns: time of the last image with a subscriber, int [ns]; -1: there was none.
    """

    def open(self) -> None:
        self._topics, self._due, self.sent_ns = {}, {}, -1
        for name, topics in self.model.description.cameras.items():
            if self._full(name) not in self.world.core.camera_names:
                continue
            info = self.world.core.camera_info(self._full(name))
            if info["width"] * info["height"] >= LARGE_PX:  # Mesa reads it once, when the first image is drawn
                os.environ.setdefault("LP_NUM_THREADS", str(len(os.sched_getaffinity(0))))
            depth = topics.depth
            self._topics[name] = {
                kind: self.advertise(topic, message, queue_size=4)
                for kind, topic, message in (("image", topics.image, Image), ("info", topics.info, CameraInfo),
                                             ("depth", depth and depth.image, Image),
                                             ("depth_info", depth and depth.info, CameraInfo),
                                             ("points", depth and depth.points, PointCloud2)) if topic}
            self.listen(topics.trigger, Empty, lambda _, camera=name: self.world.core.trigger(self._full(camera)))

    def _full(self, name: str) -> str:
        """Returns the simulator's name of a camera of this model."""
        return "%s::%s" % (self.model.name, name)

    def _due_ns(self, name: str) -> int:
        due_ns = self.world.core.next_image_ns(self._full(name))
        return self.world.epoch_ns + due_ns if due_ns < NEVER_NS else NEVER_NS

    @property
    def next_ns(self) -> int:
        return min(map(self._due_ns, self._topics), default=NEVER_NS)

    def due(self, now_ns: int) -> typing.List[typing.Tuple[str, bool, bool]]:
        """Returns the requests to World.take_frames for the images that are due now."""
        due = {name: publishers for name, publishers in self._topics.items() if self._due_ns(name) == now_ns}
        self._due = {name: {kind: each for kind, each in publishers.items() if each.get_num_connections()}
                     for name, publishers in due.items()}
        return [(self._full(name), self._image_is_wanted(name, wanted), bool({"depth", "points"} & set(wanted)))
                for name, wanted in self._due.items()]

    def _image_is_wanted(self, name: str, wanted: typing.Collection[str]) -> bool:
        depth = self.model.description.cameras[name].depth
        return "image" in wanted or ("points" in wanted and depth.colors == name)

    def send_images(self, now_ns: int, frames: typing.Dict[str, typing.Any]) -> None:
        """Publishes the due images. Args: frames: result of World.take_frames."""
        for name, wanted in self._due.items():
            if not wanted:
                continue
            info = self.world.core.camera_info(self._full(name))
            message = stamped(CameraInfo, now_ns, info.pop("frame_id"), **info)
            for kind in {"info", "depth_info"} & set(self._topics[name]):
                self._topics[name][kind].publish(message)
            frame = frames[self._full(name)]
            if isinstance(frame, str):
                rospy.logerr_throttle(10.0, "camera '%s' of model '%s': %s" % (name, self.model.name, frame))
            elif {"image", "depth", "points"} & set(wanted):
                self._send(name, wanted, message.header, *frame)

    def _send(self, name: str, wanted: typing.Dict[str, rospy.Publisher], header: Header,
              image: typing.Optional[numpy.ndarray], depth_m: typing.Optional[numpy.ndarray]) -> None:
        core, depth = self.world.core, self.model.description.cameras[name].depth
        camera = self._full(name)
        if "image" in wanted:
            wanted["image"].publish(image_message(header, image, core.camera_encoding(camera)))
        if "depth" in wanted:
            values = depth.values(depth_m)
            wanted["depth"].publish(image_message(header, values, "16UC1" if depth.millimetres else "32FC1"))
        if "points" in wanted:
            colored = self._full(depth.colors)
            try:
                colors = image if colored == camera else core.render(colored)
            except ArasError as error:
                rospy.logerr_throttle(10.0, "camera '%s' of model '%s': %s" % (name, self.model.name, error))
                return
            colors = colors[..., ::-1] if core.camera_encoding(colored) == "bgr8" else colors
            points = depth.cloud(depth_m, core.camera_info(camera)["K"], colors)
            wanted["points"].publish(cloud_message(header, points))
        self.sent_ns = self.world.time_ns

    def time_reset(self, _now_ns: int) -> None:
        self.sent_ns = -1
