"""The rays of lasers: where they look, and what is measured between them."""
import numpy


def directions_of(horizontal, vertical):
    """(n, 3) unit vectors of two Scans: x ahead, y to the left, z up; those of one height follow each other."""
    heights, turns = numpy.meshgrid(vertical.angles(), horizontal.angles(), indexing="ij")
    return numpy.stack((numpy.cos(heights) * numpy.cos(turns), numpy.cos(heights) * numpy.sin(turns),
                        numpy.sin(heights)), axis=-1).reshape(-1, 3)


def resampled(values, horizontal, vertical):
    """What is measured along the rays of two Scans, (n,), as as many numbers as these say, linearly between them."""
    rows = values.reshape(vertical.samples, horizontal.samples)
    if (vertical.count, horizontal.count) == rows.shape:
        return values
    for axis, count in ((0, vertical.count), (1, horizontal.count)):
        at = numpy.linspace(0.0, rows.shape[axis] - 1.0, count)
        below = numpy.minimum(at.astype(int), max(0, rows.shape[axis] - 2))
        above = numpy.minimum(below + 1, rows.shape[axis] - 1)
        share = (at - below).reshape((-1, 1) if axis == 0 else (1, -1))
        rows = (1.0 - share) * rows.take(below, axis) + share * rows.take(above, axis)
    return rows.reshape(-1)
