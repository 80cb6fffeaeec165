"""Images of cameras with more than 8 bits a value."""

import numpy as np


def eight_bit(image):
    """The image with 8 bits a value: itself, or, of uint16, 255 / 65535 of it, rounded, as cv_bridge converts it."""
    if image.dtype != np.uint16:
        return image
    return ((image.astype(np.uint32) + 128) // 257).astype(np.uint8)
