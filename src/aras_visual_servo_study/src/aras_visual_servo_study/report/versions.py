"""Versions of the programs and libraries that a result depends on, read from the installed files without ROS."""

import fnmatch
import functools
import glob
import os
import platform
import re
import xml.etree.ElementTree
from importlib import metadata
from pathlib import Path
from typing import Dict

from aras_visual_servo import share_dir

# Shared libraries of Debian's packages. The version is part of the file name.
_LIBRARIES = {"visp": "libvisp_core.so.*", "bullet": "libBulletDynamics*.so.*",
              "kdl": "liborocos-kdl.so.*", "opencv": "libopencv_core.so.*"}
_FOLDERS = ("/usr/lib/*-linux-gnu", "/usr/lib", "/usr/local/lib")


@functools.lru_cache(maxsize=None)
def installed_versions() -> Dict[str, str]:
    """Version by name: this package, ViSP, Bullet, KDL, OpenCV, numpy, matplotlib, Python, system."""
    versions = {"aras_visual_servo": package_version(share_dir() / "package.xml")}
    files = [file for folder in _FOLDERS for path in glob.glob(folder) for file in os.listdir(path) if ".so." in file]
    for name, pattern in _LIBRARIES.items():
        found = fnmatch.filter(files, pattern)
        numbers = [match.group(1) for match in (re.search(r"\.so\.([0-9.]+)$", file) for file in found) if match]
        if numbers:
            versions[name] = max(numbers, key=lambda number: (number.count("."), number))
    for name in ("numpy", "matplotlib"):
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = "unknown"
    versions["python"] = platform.python_version()
    versions["system"] = _system()
    return versions


def package_version(path: Path) -> str:
    """The <version> of a package.xml, "unknown" if there is none."""
    try:
        version = xml.etree.ElementTree.parse(path).findtext("version")
    except (OSError, xml.etree.ElementTree.ParseError):
        version = None
    return version.strip() if version else "unknown"


def _system():
    try:
        name = platform.freedesktop_os_release()["PRETTY_NAME"]
    except OSError:
        name = platform.system()
    return f"{name}, {platform.machine()}"
