"""Images of cameras that are not 8-bit rgb or grey."""

from typing import Any

import numpy as np

from .errors import ShapeError


#: Encodings, as sensor_msgs/image_encodings.h names them, whose images the extractors take as they are.
AS_THEY_ARE = ("rgb8", "mono8", "rgb16", "mono16", "8UC1", "16UC1")
#: Values of one pixel of an encoding.
CHANNELS = {**{f"{colours}{bits}": len(colours) for bits in (8, 16) for colours in ("rgb", "bgr", "rgba", "bgra")},
            **{f"{grey}{bits}": 1 for bits in (8, 16)
               for grey in ("mono", "bayer_rggb", "bayer_bggr", "bayer_gbrg", "bayer_grbg")},
            **{f"{bits}UC{values}": values for bits in (8, 16) for values in (1, 3, 4)}, "yuv422": 2, "yuv422_yuy2": 2}


def in_rgb(image: np.ndarray, encoding: str) -> np.ndarray:
    """The image of a camera as the extractors take it and as people look at it.

    Args: image: (h, w) or (h, w, values of a pixel), uint8 or uint16.  encoding: of the camera.
    Returns: the same array of grey, rgb and rgba; else a new one of rgb, uint8 or uint16 as the image.
    Raises: ShapeError of aras_visual_servo_camera: another encoding, or an image that does not have its shape.
    """
    if encoding in AS_THEY_ARE:
        return image
    from aras_visual_servo_camera import in_rgb as converted  # C++: not needed to import this
    return converted(image, encoding)


def image_of(message: Any) -> np.ndarray:
    """The image of a sensor_msgs/Image, (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, uint8 or, of 16 bits a value,
    uint16; a copy.

    Raises: ShapeError: another encoding.
    """
    channels = CHANNELS.get(message.encoding)
    if channels is None:
        raise ShapeError(f"image encoding: found '{message.encoding}', allowed {' | '.join(CHANNELS)}")
    value = np.dtype("<u2" if "16" in message.encoding else "u1")
    value = value.newbyteorder(">") if message.is_bigendian else value
    rows = np.frombuffer(message.data, dtype=np.uint8).reshape(message.height, message.step)
    image = rows[:, :message.width * channels * value.itemsize].copy().view(value)
    image = image.astype(value.newbyteorder("=")).reshape(message.height, message.width, channels)
    return in_rgb(image[..., 0] if channels == 1 else image, message.encoding)


def eight_bit(image: np.ndarray) -> np.ndarray:
    """The image with 8 bits a value: itself, or, of uint16, 255 / 65535 of it, rounded, as cv_bridge converts it."""
    if image.dtype != np.uint16:
        return image
    return ((image.astype(np.uint32) + 128) // 257).astype(np.uint8)
