"""Images of cameras that are not 8-bit rgb or grey."""

import numpy as np

from .errors import ShapeError


#: Encodings, as sensor_msgs/image_encodings.h names them, whose images the extractors take as they are.
AS_THEY_ARE = ("rgb8", "mono8", "rgb16", "mono16")
#: Values of one pixel of an encoding.
CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1, "rgb16": 3, "mono16": 1, "bayer_rggb8": 1, "bayer_bggr8": 1,
            "bayer_gbrg8": 1, "bayer_grbg8": 1}


def in_rgb(image, encoding):
    """The image of a camera as the extractors take it and as people look at it.

    Args: image: (h, w) or (h, w, 3), uint8 or uint16.  encoding: of the camera.
    Returns: the same array; of bgr8 and of a Bayer pattern a new one of rgb8.
    Raises: ShapeError of aras_visual_servo_camera: another encoding, or an image that does not have its shape.
    """
    if encoding in AS_THEY_ARE:
        return image
    from aras_visual_servo_camera import in_rgb as converted  # C++: not needed to import this
    return converted(image, encoding)


def image_of(message):
    """The image of a sensor_msgs/Image, (h, w) grey or (h, w, 3) rgb, uint8 or, of 16 bits a value, uint16; a copy.

    Raises: ShapeError: another encoding.
    """
    channels = CHANNELS.get(message.encoding)
    if channels is None:
        raise ShapeError(f"image encoding: found '{message.encoding}', allowed {' | '.join(CHANNELS)}")
    value = np.dtype("<u2" if message.encoding.endswith("16") else "u1")
    value = value.newbyteorder(">") if message.is_bigendian else value
    rows = np.frombuffer(message.data, dtype=np.uint8).reshape(message.height, message.step)
    image = rows[:, :message.width * channels * value.itemsize].copy().view(value)
    image = image.astype(value.newbyteorder("=")).reshape(message.height, message.width, channels)
    return in_rgb(image[..., 0] if channels == 1 else image, message.encoding)


def eight_bit(image):
    """The image with 8 bits a value: itself, or, of uint16, 255 / 65535 of it, rounded, as cv_bridge converts it."""
    if image.dtype != np.uint16:
        return image
    return ((image.astype(np.uint32) + 128) // 257).astype(np.uint8)
