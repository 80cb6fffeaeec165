"""The program gazebo-doctor: one table of the missing dependencies of a launch file."""
import argparse
import os
import typing

import rospkg

from ..node.folders import Folders
from . import python
from .findings import Finding, table
from .launch import Launch


def launch_file(package: str, name: str) -> str:
    """Returns the path of a launch file, as roslaunch finds it: anywhere in the package. Raises: OSError,
    rospkg.ResourceNotFound."""
    if os.path.isfile(package) and not name:
        return os.path.abspath(package)
    folder = rospkg.RosPack().get_path(package)
    for place, _, files in sorted(os.walk(folder)):
        if name in files:
            return os.path.join(place, name)
    raise FileNotFoundError("there is no file %s in %s" % (name, folder))


def is_strangers(folder: str) -> bool:
    """Whether a package is one of the user's sources: neither Debian's nor installed."""
    return not folder.startswith(("/usr/", "/opt/ros/")) and "/share/" not in folder + "/"


def examine(path: str, arguments: typing.Dict[str, str]) -> typing.List[Finding]:
    """Returns list of Finding of a launch file. Args: arguments: dict of its <arg>s."""
    launch = Launch(Folders(dict(os.environ)))
    launch.package_of(path)
    launch.walk(path, arguments)
    findings = list(launch.findings)
    for folder in dict.fromkeys(filter(is_strangers, launch.packages.values())):
        files = list(python.files_of(folder))
        own = {*launch.packages, *python.modules_in(files)}
        for file in files:
            findings += python.findings_of(file, own)
        findings += python.wrong_interpreter(files)
    return findings


def main(arguments: typing.Optional[typing.Sequence[str]] = None) -> int:
    """Returns 0: nothing is missing, 1: a dependency is missing, 2: there is no such launch file."""
    parser = argparse.ArgumentParser(prog="gazebo-doctor", description="Lists what a launch file needs and cannot "
                                     "find: packages, programs, plugins, models, meshes, Python 2 code.")
    parser.add_argument("package", help="name of a package, or path of a launch file")
    parser.add_argument("launch", nargs="?", default="", help="name of the launch file")
    parser.add_argument("args", nargs="*", metavar="NAME:=VALUE", help="its arguments")
    options = parser.parse_args(arguments)
    words = [options.launch, *options.args]
    given = dict(word.split(":=", 1) for word in words if ":=" in word)
    name = next((word for word in words if word and ":=" not in word), "")
    try:
        path = launch_file(options.package, name)
    except rospkg.ResourceNotFound:
        print("gazebo-doctor: there is no package '%s' in ROS_PACKAGE_PATH" % options.package)
        return 2
    except OSError as error:
        print("gazebo-doctor: %s" % error)
        return 2
    lines = table(examine(path, given), rospkg.RosPack())
    print("\n".join(lines) if lines else "%s: nothing is missing" % path)
    return 1 if lines else 0
