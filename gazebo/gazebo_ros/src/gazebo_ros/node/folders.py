"""Where packages, models and resources are, as ROS and Gazebo look for them."""
import itertools
import os
import re
import typing

import rospkg

from ..sdf.document import NoFolders

MODEL_PATH, RESOURCE_PATH = "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH"
DOWNLOADED = "~/.gazebo/models"  #: where Gazebo puts models of its database


class Folders(NoFolders):
    """Callable: the folder of a package or model, or None. Results are cached.

    Attributes: environment: mapping of the variables that name folders.
    """

    def __init__(self, environment: typing.MutableMapping[str, str] = os.environ) -> None:
        self.environment = environment
        self._packages = rospkg.RosPack()
        self._exported = {}

    def __call__(self, name: str) -> typing.Optional[str]:
        own = (DOWNLOADED, os.path.join(self._package("gazebo_ros") or "", "models"))
        for place in itertools.chain(self._places(MODEL_PATH, "gazebo_model_path"), own):
            folder = os.path.join(os.path.expanduser(place), name)
            if os.path.isdir(folder):
                return folder
        return self._package(name)

    def resource(self, path: str) -> typing.Optional[str]:
        """Whole path of a file, from the working folder, GAZEBO_RESOURCE_PATH or a package's gazebo_media_path."""
        for place in itertools.chain((".",), self._places(RESOURCE_PATH, "gazebo_media_path")):
            if os.path.isfile(os.path.join(place, path)):
                return os.path.abspath(os.path.join(place, path))
        return None

    def _places(self, variable: str, key: str) -> typing.Iterator[str]:
        """The folders of a variable of the environment, then those that packages export."""
        yield from filter(None, self.environment.get(variable, "").split(":"))
        yield from self._exports(key)

    def _package(self, name: str) -> typing.Optional[str]:
        try:
            return self._packages.get_path(name)
        except rospkg.ResourceNotFound:
            return None

    def _exports(self, key: str) -> typing.List[str]:
        """Folders that packages name in <export><gazebo_ros KEY="..."/></export>."""
        if key not in self._exported:
            named = re.compile("<gazebo_ros[^>]*%s\\s*=\\s*['\"]([^'\"]*)['\"]" % key)
            self._exported[key] = [
                place.replace("${prefix}", folder) for folder in map(self._package, self._packages.list())
                for value in named.findall(manifest(folder)) for place in value.split(":") if place]
        return self._exported[key]


def manifest(folder: str) -> str:
    """Text of a package's package.xml."""
    try:
        with open(os.path.join(folder, "package.xml"), encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""
