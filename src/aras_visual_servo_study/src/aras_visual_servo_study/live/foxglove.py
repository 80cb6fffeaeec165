"""The run for Foxglove: what a page is told, sent once more by Foxglove's websocket protocol (foxglove-sdk, an extra).

    peer = Foxglove(hub, runner.urdf_xml, 8766)       # MissingExtra, ParameterError
    hub.tick(); peer.tick()                           # as often as pages are told
    peer.close()

The hub regards it as one more page, as long as a program subscribes. Nothing can be changed through it, and it listens
on 127.0.0.1 only. Times are simulated.
"""

import json
import math
import struct
from typing import Any, Callable, Dict, List, Optional, Set, Tuple, Union

import numpy as np

from aras_visual_servo import ParameterError, extra, resolve_uri, spatial
from .hub import Hub
from .view.robot import robot_of, triangles_of

HOST = "127.0.0.1"
#: Frames beside the links of the robot: the world, the camera's optical frame, the target.
WORLD, CAMERA, TARGET = "world", "camera_view", "target_view"
#: Topic -> kind of its channel in the SDK.
TOPICS = {"/camera/image": "CompressedImage", "/camera/goal": "CompressedImage",
          "/camera/calibration": "CameraCalibration", "/scene": "SceneUpdate", "/tf": "FrameTransforms",
          "/log": "Log"}
NUMBERS = {"type": "number"}
STAMP = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
#: Groups of columns of a row: prefix -> key of the message.
GROUPS = {"e.": "errors", "v.": "twist", "q.": "joints"}
SINGLE = ("condition", "manipulability", "real_time_factor", "u", "v")
LEVELS = {"FAULT": "Error", "TARGET_LOST": "Error", "STALE_INPUT": "Error", "JOINT_LIMIT": "Warning",
          "NEAR_SINGULARITY": "Warning", "OUT_OF_REACH": "Warning", "TIMED_OUT": "Warning"}
OUTLINE_PX = 3.0


class Foxglove:
    """Serves. Attributes: port: on which it listens.

    Args: hub: of the run.  urdf_xml: gives the robot's description.  port: 0 takes a free one.
    Raises: MissingExtra: foxglove-sdk is not there.  ParameterError: the port is taken.
    """

    behind, next_row, image_number = 0, 0, -1  # of a page, as the hub sees it

    def __init__(self, hub: Hub, urdf_xml: Callable[[], str], port: int) -> None:
        library = extra("foxglove", "--foxglove")
        self._messages, channels, websocket = (extra(f"foxglove.{name}", "--foxglove")
                                               for name in ("messages", "channels", "websocket"))
        self._channel = library.Channel
        self._hub, self._urdf_xml, self._context = hub, urdf_xml, library.Context()
        self._to = {topic: getattr(channels, f"{kind}Channel")(topic, context=self._context)
                    for topic, kind in TOPICS.items()}
        self._servo: Any = None
        self._features: Any = None
        self._names: List[str] = []
        self._about: Dict[str, Any] = {}
        self._goal: Optional[bytes] = None
        self._told, self._t, self._anew = ("", ""), -1.0, False
        self._wanted: Set[Tuple[int, int]] = set()
        try:
            self._server = library.start_server(
                name="ARAS visual servo", host=HOST, port=port, context=self._context, server_listener=self,
                capabilities=[websocket.Capability.Time])
        except RuntimeError as error:
            raise ParameterError(f"--foxglove: found {port}, allowed a port of {HOST} that is free, or 0: "
                                 f"{error}") from error
        self.port: int = self._server.port

    # --- what the library tells, in its own threads ---------------------------------------------------------------

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """A program wants a topic: it gets the scene, the calibration and the goal again."""
        self._wanted.add((client.id, channel.id))
        self._anew = True

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """A program has had enough of a topic, or has gone."""
        self._wanted.discard((client.id, channel.id))

    # --- what the hub asks for ------------------------------------------------------------------------------------

    def tick(self) -> None:
        """Comes to the hub as a page while a program subscribes; sends again what a new one has missed."""
        present = self in self._hub
        if self._wanted and not present:
            self._hub.add(self)
        elif not self._wanted and present:
            self._hub.remove(self)
        if self._anew and self._about and self._t >= 0.0:
            self._anew, self.image_number = False, -1
            self._send_scene()
            if self._goal is not None:
                self._image("/camera/goal", self._goal)

    def send(self, message: Union[str, bytes]) -> None:
        """Translates a message for pages."""
        if isinstance(message, str):
            told = json.loads(message)
            if told["type"] == "about":
                self._describe(told)
            return
        size, = struct.unpack_from("<I", message)
        head, image = json.loads(message[4:4 + size]), message[4 + size:]
        if head["type"] == "goal":
            self._goal = image
            self._image("/camera/goal", image)
            return
        self.behind = 0
        for row in head["rows"]:
            self._row(row)
        self._state(head["state"])
        if image:
            self._image("/camera/image", image)
            self._calibration()

    def close(self) -> None:
        """Stops serving."""
        self._hub.remove(self)
        self._server.stop()

    # --- messages -------------------------------------------------------------------------------------------------

    def _describe(self, about: Dict[str, Any]) -> None:
        """Makes the channel of numbers for these features and joints."""
        if self._about.get("rows") != about["rows"]:
            for channel in (self._servo, self._features):
                if channel is not None:
                    channel.close()
            groups = {key: {"type": "object", "properties": {
                name[len(prefix):]: NUMBERS for name in about["rows"] if name.startswith(prefix)}}
                for prefix, key in GROUPS.items()}
            schema = {"type": "object", "title": "aras.Servo", "properties": {
                "timestamp": STAMP, "status": {"type": "string"}, "servoing": {"type": "boolean"}, **groups,
                **dict.fromkeys(SINGLE, NUMBERS)}}
            self._servo = self._channel("/servo", schema=schema, context=self._context)
            self._names = [feature["name"] for feature in about["features"]]
            self._features = self._channel("/features", context=self._context, schema={
                "type": "object", "title": "aras.Features", "properties": dict.fromkeys(self._names, NUMBERS)})
        self._about, self._anew = about, True

    def _row(self, row: List[Optional[float]]) -> None:
        named = dict(zip(self._about["rows"], row))
        t = named["t"] or 0.0
        if t < self._t:
            self._server.clear_session()  # the run began anew
            self._anew = True
        self._t = t
        message: Dict[str, Any] = {"timestamp": _stamp(t), "servoing": bool(named["servo"]),
                                   "status": self._about["statuses"][int(named["status"] or 0)]}
        for prefix, key in GROUPS.items():
            message[key] = {name[len(prefix):]: value for name, value in named.items()
                            if name.startswith(prefix) and value is not None}
        message.update((name, named[name]) for name in SINGLE if named[name] is not None)
        self._servo.log(message, log_time=_ns(t))

    def _state(self, state: Dict[str, Any]) -> None:
        t = state["t"]
        self._server.broadcast_time(_ns(t))
        self._t = max(self._t, 0.0)
        self._log("/tf", t, self._messages.FrameTransforms(transforms=self._transforms(state)))
        seen = {name: value for name, value in zip(self._names, state["s"]) if value is not None}
        if seen:
            self._features.log(seen, log_time=_ns(t))
        # While it servoes, the text has numbers that change with every image.
        told = state["status"], "" if state["status"] == "SERVOING" else state["text"]
        if told != self._told:
            self._told = told
            level = getattr(self._messages.LogLevel, LEVELS.get(state["status"], "Info"))
            self._log("/log", t, self._messages.Log(
                timestamp=self._time(t), level=level, name=self._about["scenario"],
                message=" ".join(filter(None, (f"{state['status']}:", state["text"], state["advice"])))))

    def _transforms(self, state: Dict[str, Any]) -> List[Any]:
        """The camera, the target, and each link in its parent."""
        about, t = self._about, state["t"]
        q = dict(zip((joint["name"] for joint in about["joints"]), state["q"]))
        poses: Dict[str, np.ndarray] = {}
        found = []
        for joint in about["robot"]["joints"]:
            X = spatial.pose_from_rpy(joint["xyz"], joint["rpy"]) @ _moved(joint, q.get(joint["name"]) or 0.0)
            poses[joint["child"]] = X
            found.append(self._transform(t, joint["parent"], joint["child"], X))
        root, X_WC = about["robot"]["root"], _pose(state["camera"])
        if X_WC is not None:
            found.append(self._transform(t, WORLD, CAMERA, X_WC))
        if root != WORLD:
            X_WR = np.eye(4)
            if about["floating"] and X_WC is not None:
                parents, link, X_RC = {joint["child"]: joint["parent"] for joint in about["robot"]["joints"]}, \
                    about["tip"], np.eye(4)
                while link != root:
                    link, X_RC = parents[link], poses[link] @ X_RC
                X_WR = X_WC @ spatial.inverse(X_RC)
            found.append(self._transform(t, WORLD, root, X_WR))
        X_WT = _pose(state["target"])
        if X_WT is not None:
            found.append(self._transform(t, WORLD, TARGET, X_WT))
        return found

    def _transform(self, t: float, parent: str, child: str, X: np.ndarray) -> Any:
        x, y, z, w = map(float, spatial.quaternion_xyzw(X[:3, :3]))
        return self._messages.FrameTransform(
            timestamp=self._time(t), parent_frame_id=parent, child_frame_id=child,
            translation=self._messages.Vector3(x=float(X[0, 3]), y=float(X[1, 3]), z=float(X[2, 3])),
            rotation=self._messages.Quaternion(x=x, y=y, z=z, w=w))

    def _image(self, topic: str, data: bytes) -> None:
        self._log(topic, self._t, self._messages.CompressedImage(timestamp=self._time(self._t), frame_id=CAMERA,
                                                                 data=data, format="jpeg"))

    def _calibration(self) -> None:
        camera = self._about["camera"]
        K = [float(x) for x in camera["K"]]
        self._log("/camera/calibration", self._t, self._messages.CameraCalibration(
            timestamp=self._time(self._t), frame_id=CAMERA, width=camera["width"], height=camera["height"],
            distortion_model=camera["distortion_model"], D=camera["D"], K=K,
            R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], P=[*K[:3], 0.0, *K[3:6], 0.0, *K[6:], 0.0]))

    # --- the scene ------------------------------------------------------------------------------------------------

    def _send_scene(self) -> None:
        scene, entities = self._about["scene"], []
        robot = robot_of(self._urdf_xml())
        for link, visuals in robot["links"].items():
            shapes = _Shapes(self._messages)
            for visual in visuals:
                shapes.add(visual, robot["meshes"])
            entities.append(self._entity(f"link {link}", link, shapes))
        for number, model in enumerate(scene["models"]):
            shapes = _Shapes(self._messages)
            moves = number == 0 and model["name"] == self._about["target"]
            shapes.model(model, None if moves else model["pose"])
            entities.append(self._entity(f"model {model['name']}", TARGET if moves else WORLD, shapes))
        for solid in scene["solids"]:
            shapes = _Shapes(self._messages)
            shapes.solid(solid)
            entities.append(self._entity(f"solid {solid['name']}", WORLD, shapes))
        everything = self._messages.SceneEntityDeletion(type=self._messages.SceneEntityDeletionType.All)
        self._log("/scene", self._t, self._messages.SceneUpdate(deletions=[everything], entities=entities))
        self._calibration()

    def _entity(self, name: str, frame: str, shapes: "_Shapes") -> Any:
        return self._messages.SceneEntity(timestamp=self._time(self._t), frame_id=frame, id=name, frame_locked=True,
                                          **shapes.lists)

    def _log(self, topic: str, t: float, message: Any) -> None:
        self._to[topic].log(message, log_time=_ns(t))

    def _time(self, t: float) -> Any:
        return self._messages.Timestamp(**_stamp(t))


class _Shapes:
    """Primitives of one entity. Attributes: lists: keyword of `SceneEntity` -> list."""

    def __init__(self, messages: Any) -> None:
        self._m = messages
        self.lists: Dict[str, List[Any]] = {"cubes": [], "spheres": [], "cylinders": [], "lines": [], "triangles": []}

    def add(self, visual: Dict[str, Any], meshes: Dict[str, str]) -> None:
        """Adds a visual of a link (`robot_of`)."""
        X, color = spatial.pose_from_rpy(visual["xyz"], visual["rpy"]), visual["color"]
        if "mesh" in visual:
            try:
                corners = triangles_of(resolve_uri(meshes[visual["mesh"]], key="mesh")).reshape(-1, 3)
            except (RuntimeError, OSError):
                return  # the page's notes name it
            points, index = np.unique(np.round(corners * visual["scale"], 5), axis=0, return_inverse=True)
            self.lists["triangles"].append(self._m.TriangleListPrimitive(
                pose=self._pose(X), points=[self._m.Point3(x=x, y=y, z=z) for x, y, z in points.tolist()],
                color=self._color(color), indices=index.ravel().tolist()))
        else:
            self._solid(visual, X, color)

    def solid(self, solid: Dict[str, Any]) -> None:
        """Adds a solid of the scene (`scene_of`)."""
        X = _pose(solid["pose"])
        assert X is not None
        self._solid(solid, X, [x / 255.0 for x in solid["color"]])

    def _solid(self, shape: Dict[str, Any], X: np.ndarray, color: List[float]) -> None:
        pose, color = self._pose(X), self._color(color)
        if "box" in shape:
            self.lists["cubes"].append(self._m.CubePrimitive(pose=pose, size=self._size(*shape["box"]), color=color))
        elif "cylinder" in shape:
            radius, length = shape["cylinder"]
            self.lists["cylinders"].append(self._m.CylinderPrimitive(
                pose=pose, size=self._size(2 * radius, 2 * radius, length), bottom_scale=1.0, top_scale=1.0,
                color=color))
        else:
            size = 2 * float(np.ravel(shape["sphere"])[0])
            self.lists["spheres"].append(self._m.SpherePrimitive(pose=pose, size=self._size(size, size, size),
                                                                 color=color))

    def model(self, model: Dict[str, Any], pose: Optional[List[float]]) -> None:
        """Adds a flat model (`scene_of`): its board and outlines. Args: pose: None: of the frame."""
        X = _pose(pose)
        at = self._pose(np.eye(4) if X is None else X)
        board = model.get("board") or model.get("image")
        if board:
            color = [x / 255.0 for x in board.get("color", (255, 255, 255))]
            width, height = np.broadcast_to(board["size"], 2).tolist()
            self.lists["cubes"].append(self._m.CubePrimitive(pose=at, size=self._size(width, height, 1e-4),
                                                             color=self._color(color)))
        for outline in model["outlines"]:
            points = [self._m.Point3(x=float(x), y=float(y), z=1e-3) for x, y in outline]
            self.lists["lines"].append(self._m.LinePrimitive(
                type=self._m.LinePrimitiveLineType.LineLoop, pose=at, thickness=OUTLINE_PX, scale_invariant=True,
                points=points, color=self._color([x / 255.0 for x in model["color"]])))

    def _pose(self, X: np.ndarray) -> Any:
        x, y, z, w = map(float, spatial.quaternion_xyzw(X[:3, :3]))
        return self._m.Pose(position=self._size(*X[:3, 3]), orientation=self._m.Quaternion(x=x, y=y, z=z, w=w))

    def _size(self, x: float, y: float, z: float) -> Any:
        return self._m.Vector3(x=float(x), y=float(y), z=float(z))

    def _color(self, color: Any) -> Any:
        r, g, b, a = [*map(float, color), 1.0][:4]
        return self._m.Color(r=r, g=g, b=b, a=a)


def _moved(joint: Dict[str, Any], q: float) -> np.ndarray:
    """X of a joint at q [m, rad], in its own frame."""
    axis = np.array(joint["axis"], dtype=float)
    axis /= np.linalg.norm(axis) or 1.0
    if joint["type"] == "prismatic":
        return spatial.transform(np.eye(3), q * axis)
    turned = joint["type"] in ("revolute", "continuous")
    return spatial.transform(spatial.rotation(q * axis), np.zeros(3)) if turned else np.eye(4)


def _pose(numbers: Optional[List[float]]) -> Optional[np.ndarray]:
    return None if numbers is None else spatial.pose_from_quaternion(numbers[:3], numbers[3:])


def _ns(t: float) -> int:
    return max(0, round(1e9 * t))


def _stamp(t: float) -> Dict[str, int]:
    whole = math.floor(t)
    return {"sec": whole, "nsec": min(999_999_999, round(1e9 * (t - whole)))}
