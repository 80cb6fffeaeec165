"""Nodelets: classes that a launch file loads into a manager by name, and the files that say where they are."""
import functools
import glob
import os
import typing
import xml.etree.ElementTree as ElementTree

import rospkg

LOADING = ("load", "standalone")  #: commands of the program nodelet that name a class
SYSTEM = ("/usr/lib", "/usr/lib/*-linux-gnu")  #: where Debian's libraries are, beside those of the workspaces


class Nodelets:
    """Classes that nodelet's loader finds in the files that packages export to `nodelet`."""

    def __init__(self, packages: rospkg.RosPack) -> None:
        """Args: packages: finds the packages."""
        self._packages = packages

    def fault(self, words: typing.Sequence[str]) -> typing.Optional[typing.Tuple[str, str]]:
        """Returns (name of the class, its fault), None: it can be loaded, or none is named.

        Args: words: command line of the program nodelet.
        """
        if len(words) < 2 or words[0] not in LOADING:
            return None
        name = words[1]
        package = name.partition("/")[0]
        if name not in self._libraries:
            return name, self._absent(package)
        library = self._libraries[name]
        if not is_library(library, self._folder(package)):
            return name, "its library %s is not there: has the package been built?" % library
        return None

    def _absent(self, package: str) -> str:
        folder = self._folder(package)
        if folder is None:
            return "is in no folder of ROS_PACKAGE_PATH"
        missing = [file for file in exported(self._packages, package) if not os.path.isfile(file)]
        if missing and folder.startswith("/usr/share/"):
            return "Debian's package lib%s-dev has the list of its nodelets" % package.replace("_", "-")
        if missing:
            return "the list of its package is not there: %s" % missing[0]
        return "is not in the list of nodelets of its package"

    def _folder(self, package: str) -> typing.Optional[str]:
        return self._packages.get_path(package) if package in self._packages.list() else None

    @functools.cached_property
    def _libraries(self) -> typing.Dict[str, str]:
        """Library of each class."""
        found: typing.Dict[str, str] = {}
        for package in self._packages.list():
            for file in exported(self._packages, package):
                found.update(classes_in(file))
        return found


def exported(packages: rospkg.RosPack, package: str) -> typing.List[str]:
    """Returns the files of nodelets that a package.xml names, whether they are there or not."""
    try:
        manifest = packages.get_manifest(package)
    except (rospkg.InvalidManifest, rospkg.ResourceNotFound, OSError):
        return []
    return [file.replace("${prefix}", packages.get_path(package)) for file in manifest.get_export("nodelet", "plugin")]


def classes_in(file: str) -> typing.Dict[str, str]:
    """Returns the library of each class that a file of plugins has; none of a file that is missing or broken."""
    try:
        root = ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError):
        return {}
    return {each.get("name") or each.get("type", ""): library.get("path", "")
            for library in root.iter("library") for each in library.iter("class")}


def is_library(path: str, folder: typing.Optional[str]) -> bool:
    """Whether a library is there. Args: path: as a file of plugins has it.  folder: of its package."""
    name = os.path.basename(path)
    prefixes = [each for each in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if each]
    places = [os.path.join(each, "lib") for each in prefixes] + [*SYSTEM]
    if folder is not None:
        places += [folder, os.path.join(folder, os.path.dirname(path))]
    return any(glob.glob(os.path.join(place, start + name + ".so")) for place in places for start in ("", "lib"))
