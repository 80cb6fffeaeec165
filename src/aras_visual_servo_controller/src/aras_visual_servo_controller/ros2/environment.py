"""The environment of ROS 2 programs: where it is, whether it is whole, and the variables that they run with."""

import os
import subprocess
from pathlib import Path
from typing import Dict, List, Mapping, Optional, Sequence

from aras_visual_servo import ArasError, ParameterError

FOLDER = Path("build") / "ros2"
INSTALL = "`script/bootstrap --ros2`"
#: Variables that a shell has only after ROS 2's setup file.
OF_ROS2 = ("AMENT_PREFIX_PATH", "AMENT_CURRENT_PREFIX")
#: Lists of folders -> what a folder of ROS 2 in them has.
LISTS = {"PYTHONPATH": "rclpy/__init__.py", "LD_LIBRARY_PATH": "librcl.so", "CMAKE_PREFIX_PATH": "share/rclcpp"}
#: Variables that ROS 2 programs do not get: they belong to ROS 1, or could open a network.
DROPPED = ("PYTHONPATH", "PYTHONHOME", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH", "ROS_DISTRO", "ROS_VERSION",
           "ROS_PYTHON_VERSION", "ROS_NAMESPACE", "ROS_PACKAGE_PATH", "ROS_ETC_DIR", "ROS_ROOT",
           "_ROS_WHEELS_BOOTSTRAP_COMPLETE", "FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE",
           *OF_ROS2)

#: Shared memory carries messages and discovery, so that no program listens on a network. The sizes let an image of
#: 1280 x 720 pass in two parts. With the range LOCALHOST rmw_fastrtps would add UDP sockets on all addresses.
TRANSPORT = {"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
             "FASTDDS_BUILTIN_TRANSPORTS": "SHM?max_msg_size=2MB&sockets_size=8MB"}


def shell_faults(environ: Mapping[str, str]) -> List[str]:
    """Returns a sentence for each variable that brings another ROS 2 into this shell."""
    faults = [f"{name}: found '{environ[name]}', allowed is a shell without ROS 2" for name in OF_ROS2
              if environ.get(name)]
    if environ.get("ROS_VERSION", "1") != "1":
        faults.append(f"ROS_VERSION: found '{environ['ROS_VERSION']}', allowed 1")
    for name, holds in LISTS.items():
        faults += [f"{name}: found '{folder}', which belongs to ROS 2; allowed are folders of ROS 1"
                   for folder in environ.get(name, "").split(os.pathsep) if folder and (Path(folder) / holds).exists()]
    return faults


def check_shell(environ: Mapping[str, str]) -> None:
    """Raises ParameterError: two ROS are in one shell; it names every variable."""
    faults = shell_faults(environ)
    if faults:
        raise ParameterError([*faults, "ROS 1 and ROS 2 have packages of the same names: open a new shell, and source "
                              "install/setup.sh only"])


def find_environment(start: Path = Path(__file__)) -> Path:
    """Returns the folder of the ROS 2 environment. Args: start: it is looked for in the folders above this.

    Raises: ArasError: there is none, it is not whole, or it was made for an older list of packages.
    """
    workspace = next((parent for parent in start.resolve().parents if (parent / FOLDER).is_dir()), None)
    if workspace is None:
        raise ArasError(f"ROS 2: found no {FOLDER}, which {INSTALL} makes (44 MB of wheels from PyPI)")
    folder, listed = workspace / FOLDER, workspace / "ros2" / "requirements.txt"
    made = folder / "installed.txt"
    if not made.is_file() or not (folder / "types.txt").is_file():
        raise ArasError(f"ROS 2: {folder} is not whole; run {INSTALL} again")
    if listed.is_file() and made.read_text(encoding="utf-8") != listed.read_text(encoding="utf-8"):
        raise ArasError(f"ROS 2: {folder} was made by another version of this workspace; run {INSTALL} again")
    return folder


def variables(environ: Mapping[str, str]) -> Dict[str, str]:
    """Returns the environment variables of a ROS 2 program on this machine, see TRANSPORT."""
    return {**{name: value for name, value in environ.items() if name not in DROPPED}, **TRANSPORT}


def start(command: Sequence[str], environ: Mapping[str, str], pass_fds: Sequence[int] = (),
          folder: Optional[Path] = None) -> "subprocess.Popen[bytes]":
    """Starts a Python program in the ROS 2 environment. Args: folder: of the environment; None: it is looked for."""
    python = (folder or find_environment()) / "bin" / "python"
    return subprocess.Popen([str(python), *command], env=variables(environ), pass_fds=pass_fds)
