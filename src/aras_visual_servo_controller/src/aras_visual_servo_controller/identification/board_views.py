"""Finds a calibration board in the images of a bag."""

from typing import Any, Optional, Tuple

import numpy as np

from aras_visual_servo import ParameterError, image_of
from ..calibration.boards import Board
from ..calibration.camera import MODELS, CameraCalibration
from ..bags.any_bag import AnyBag, stamp_s

IMAGE, COMPRESSED, INFO = "sensor_msgs/Image", "sensor_msgs/CompressedImage", "sensor_msgs/CameraInfo"
#: End of the topics of compressed images, as image_transport names them beside those of the images.
COMPRESSED_END = "/compressed"
#: Images in which the board is looked for, at most; they are spread over the bag.
MOST_IMAGES = 150


def read_board_views(bag: AnyBag, board: Board, topic: Optional[str] = None) -> Tuple[CameraCalibration, Any, Any]:
    """Returns (camera as camera_info has it, (f,) stamps [s], (f, n, 2) pixels) of the images in which the board is.

    Args: topic: of the images, where the bag has several.
    Raises: ParameterError: no or several topics of images, no usable camera_info beside them, the board in none, a
    compressed image that cannot be read.
    """
    types = bag.types
    images = sorted(name for name, kind in types.items() if kind in (IMAGE, COMPRESSED))
    if topic is not None and topic not in images:
        raise ParameterError(f"--images: found {topic}, allowed {', '.join(images) or 'a bag with images'}")
    if topic is None and len(images) != 1:
        raise ParameterError(f"bag '{bag.name}': found images on {', '.join(images) or 'no topic'}, allowed one topic"
                             + (": choose it with --images TOPIC" if images else ""))
    topic = topic or images[0]
    beside = topic.removesuffix(COMPRESSED_END).rpartition("/")[0] + "/camera_info"
    if types.get(beside) != INFO:
        raise ParameterError(f"bag '{bag.name}': {beside}: found none beside {topic}, allowed the camera_info of the "
                             "images: record it, too")
    camera = _camera(next((message for _, message, _ in bag.messages([beside])), None), f"bag '{bag.name}': {beside}")
    count = bag.count(topic)
    chosen = set(np.unique(np.linspace(0, count - 1, min(count, MOST_IMAGES)).round().astype(int)).tolist())
    stamps, pixels = [], []
    for k, (_, message, _) in enumerate(bag.messages([topic])):
        view = board.find(_image(message, types[topic], f"bag '{bag.name}': {topic}")) if k in chosen else None
        if view is not None:
            stamps.append(stamp_s(message))
            pixels.append(view)
    if not stamps:
        raise ParameterError(f"bag '{bag.name}': {topic}: found the board in none of {len(chosen)} images, allowed one "
                             f"of {board.columns} columns and {board.rows} rows, wholly in view")
    return camera, np.array(stamps), np.array(pixels)


def _image(message: Any, kind: str, where: str) -> np.ndarray:
    """(h, w) or (h, w, 3), uint8, of an Image or a CompressedImage. Raises ParameterError: no JPEG or PNG file."""
    if kind == IMAGE:
        return image_of(message)
    import cv2
    image = cv2.imdecode(np.frombuffer(message.data, dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise ParameterError(f"{where}: found an image of format '{message.format}' that OpenCV cannot read, allowed "
                             "JPEG and PNG files")
    return image


def _camera(message: Any, where: str) -> CameraCalibration:
    """`CameraCalibration` of a CameraInfo of ROS 1 or ROS 2. Raises ParameterError: without numbers."""
    K, D = (np.array(getattr(message, key, getattr(message, key.lower(), ())), dtype=float) for key in ("K", "D"))
    if K.size != 9 or not K[0] > 0.0:
        raise ParameterError(f"{where}: found no intrinsics, allowed a message with K: calibrate the camera")
    model = message.distortion_model or "plumb_bob"
    lens = D if D.size else np.zeros(MODELS.get(model, 0))
    if MODELS.get(model) != lens.size:
        raise ParameterError(f"{where}: distortion_model: found {model} with {lens.size} coefficients, allowed "
                             + ", ".join(f"{name} with {count}" for name, count in MODELS.items()))
    nothing = np.full(4 + lens.size, np.nan)
    return CameraCalibration(message.width, message.height, K.reshape(3, 3), lens, float("nan"), (), nothing, model)
