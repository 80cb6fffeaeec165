"""Colours of curves: named ones, shades for the members of a family, and spare ones for features without a colour.

Every colour stands out from white paper (contrast 3:1 or more). The first four are those of Okabe and Ito's palette for
colour-blind readers, the next four were searched for the largest distance from these and from each other, as people
with and without the three kinds of colour blindness see them. Distances are those of OKLab (Ottosson 2020), where equal
numbers look equally different; 0.02 is just noticeable.
"""

import functools
import math
from itertools import count, islice

import numpy as np

BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#AA4499"
NAVY, BROWN, VIOLET, MAROON = "#170393", "#614D10", "#AA71FC", "#400D07"
GREY = "#8c8c8c"  # for everything that is not a curve: axes, zero lines, notes about missing data
PALETTE = (BLUE, VERMILION, GREEN, PURPLE, NAVY, BROWN, VIOLET, MAROON)

#: Ranges of hue [deg] for families. Features in x are cool and in y warm, as BLUE and VERMILION are; lengths are green
#: and angles purple.
COOL, WARM, GREENS, PURPLES = (190.0, 290.0), (20.0, 110.0), (125.0, 175.0), (300.0, 360.0)
#: OKLab lightness of shades, from dark to the lightest that stands out from white paper; and their chroma, which
#: `shade` makes smaller where a screen cannot show so strong a colour.
LIGHTNESS, CHROMA = (0.30, 0.66), 0.17
#: Hue and lightness of the members of a family follow the R2 sequence (Roberts 2018), which keeps them far apart
#: however many there are. These are the two steps of the sequence, and the place of the first member.
STEPS, FIRST = (0.7548776662466927, 0.5698402909980532), (0.4, 0.9)
#: Two colours of one plot differ by at least this in OKLab, as long as the number of curves allows it.
LEAST_DISTANCE = 0.04
#: `spare` tries this many colours before it takes the one that is farthest from all others.
SPARES = 256

_LMS_OF_RGB = np.array([[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
                        [0.0883024619, 0.2817188376, 0.6299787005]])
_LAB_OF_LMS = np.array([[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099],
                        [0.0259040371, 0.7827717662, -0.8086757660]])


def rgb(colour):
    """(red, green, blue), 0 to 255, of "#rrggbb"."""
    return tuple(int(colour[i:i + 2], 16) for i in (1, 3, 5))


@functools.lru_cache(maxsize=1024)
def oklab(colour):
    """(lightness, a, b) of "#rrggbb" in OKLab, floats."""
    c = np.array(rgb(colour)) / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return tuple((_LAB_OF_LMS @ np.cbrt(_LMS_OF_RGB @ linear)).tolist())


def distance(a, b):
    """How different two colours look: their distance in OKLab."""
    return math.dist(oklab(a), oklab(b))


@functools.lru_cache(maxsize=1024)
def shade(hues, number):
    """Colour of member `number` (1, 2, ...) of a family whose hues lie in this range (from, to) [deg]."""
    u, v = ((first + (number - 1) * step) % 1.0 for first, step in zip(FIRST, STEPS))
    hue = math.radians(hues[0] + u * (hues[1] - hues[0]))
    lightness = LIGHTNESS[0] + v * (LIGHTNESS[1] - LIGHTNESS[0])
    for chroma in np.arange(CHROMA, -1e-9, -0.005):  # the strongest chroma that a screen can show
        lab = np.array([lightness, chroma * math.cos(hue), chroma * math.sin(hue)])
        linear = np.linalg.inv(_LMS_OF_RGB) @ (np.linalg.inv(_LAB_OF_LMS) @ lab) ** 3
        if np.all(linear > -1e-6) and np.all(linear < 1.0 + 1e-6):
            break
    linear = np.clip(linear, 0.0, 1.0)
    c = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255.0 * x):02X}" for x in c)


def spare(taken):
    """A colour at LEAST_DISTANCE or more from those taken: one of the palette, else a shade of any hue."""
    best, farthest = PALETTE[0], -1.0
    for colour in (*PALETTE, *islice((shade((0.0, 360.0), n) for n in count(1)), SPARES)):
        nearest = min((distance(colour, other) for other in taken), default=math.inf)
        if nearest >= LEAST_DISTANCE:
            return colour
        if nearest > farthest:
            best, farthest = colour, nearest
    return best
