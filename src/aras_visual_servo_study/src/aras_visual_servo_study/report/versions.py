"""Versions of the programs and libraries that a result depends on, read from the installed files without ROS."""

import fnmatch
import functools
import glob
import os
import platform
import re
from importlib import metadata
from typing import Dict

import aras_visual_servo as avs

# Shared libraries of Debian's packages. The version is part of the file name.
_LIBRARIES = {"visp": "libvisp_core.so.*", "bullet": "libBulletDynamics*.so.*",
              "kdl": "liborocos-kdl.so.*", "opencv": "libopencv_core.so.*"}
_FOLDERS = ("/usr/lib/*-linux-gnu", "/usr/lib", "/usr/local/lib")


@functools.lru_cache(maxsize=None)
def installed_versions() -> Dict[str, str]:
    """Version by name: this package, ViSP, Bullet, KDL, OpenCV, numpy, matplotlib, Python, system."""
    versions = {"aras_visual_servo": avs.__version__}
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


def _system():
    try:
        name = platform.freedesktop_os_release()["PRETTY_NAME"]
    except OSError:
        name = platform.system()
    return f"{name}, {platform.machine()}"
