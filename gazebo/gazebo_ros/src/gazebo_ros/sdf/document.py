"""Documents of SDF: expansion by libsdformat, includes, and poses."""
import os
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..world.poses import matrix_of, matrix_of_rpy
from .mend import Reader


def expanded(source: str, is_path: bool, folders: "NoFolders") -> typing.Tuple[ElementTree.Element, typing.List[str]]:
    """A document in the newest version of SDF, everything that it includes in its place.

    Args: source: a path, or the document.  folders: as World has them.
    Returns: its root element, warnings about omitted and repaired parts, one line each.
    Raises: ModelError: no SDF.
    """
    reader = Reader(lambda uri: found(uri, folders))
    return reader.expanded(source, is_path), reader.warnings


def found(uri: str, folders: "NoFolders") -> str:
    """Path of what a URI names, "" if it is nowhere: model:// and package:// of a folder, file:// and plain ones of a
    path, or of one that begins where resources are, or of one from another machine that ends in a file of a package or
    model (/opt/ros/melodic/share/PACKAGE/..., as Gazebo saves it)."""
    scheme, _, path = uri.rpartition("://")
    if scheme in ("model", "package"):
        name, _, rest = path.partition("/")
        folder = folders(name)
        return os.path.join(folder, rest).rstrip("/") if folder else ""
    if scheme in ("http", "https"):  # of a model database: "Ground Plane" is there as ground_plane
        return folders(path.rpartition("/")[2].lower().replace(" ", "_")) or ""
    if scheme not in ("", "file"):
        return ""
    if os.path.isabs(path):
        return path if os.path.exists(path) else moved(path, folders)
    return folders.resource(path) or ""


def moved(path: str, folders: "NoFolders") -> str:
    """The file of a package or model in which a path of another machine ends, "" if there is none."""
    names = path.strip("/").split("/")
    for k, name in enumerate(names[:-1]):
        folder = folders(name) if name else None
        if folder and os.path.isfile(os.path.join(folder, *names[k + 1:])):
            return os.path.join(folder, *names[k + 1:])
    return ""


class NoFolders:
    """Where packages, models and resources are: nowhere."""

    def __call__(self, name: str) -> typing.Optional[str]:
        """Folder of a package or model, or None."""
        return None

    def resource(self, path: str) -> typing.Optional[str]:
        """Whole path of a file that is named from where resources are, or None."""
        return None


def numbers(text: typing.Optional[str], count: int, what: str) -> typing.List[float]:
    """Raises: ModelError unless there are so many finite numbers."""
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        values = []
    if len(values) != count or not numpy.isfinite(values).all():
        raise ModelError("SpawnModel: Failure - entity format is invalid: %s: found '%s', allowed are %d finite "
                         "numbers" % (what, text, count))
    return values


def number(element: ElementTree.Element, path: str, otherwise: float, what: str) -> float:
    """A number in the text of a descendant. Raises: ModelError."""
    text = element.findtext(path)
    return otherwise if text is None or not text.strip() else numbers(text, 1, "%s: <%s>" % (what, path))[0]


def pose_of(element: ElementTree.Element, what: str) -> numpy.ndarray:
    """(4, 4) of an element's <pose>, in the frame that it stands in. Raises: ModelError."""
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return numpy.eye(4)
    if pose.get("rotation_format") == "quat_xyzw":
        values = numbers(pose.text, 7, what + ": <pose>")
        return matrix_of(values[:3], values[3:], what)
    values = numbers(pose.text, 6, what + ": <pose>")
    angles = numpy.radians(values[3:]) if pose.get("degrees") == "true" else numpy.asarray(values[3:])
    return matrix_of_rpy(values[:3], angles)
