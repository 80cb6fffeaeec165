"""Builds ROS 2 types of this workspace's interfaces, and of tf2_msgs, for the environment that runs this program.

    build/ros2/bin/python ros2/make_types.py src/aras_visual_servo_msgs

The generators of rosidl write C and Python code, and the compiler makes one library a package of it. ROS 2 allows
lower-case field names only: PhotometricFeatures.H becomes h.
"""

import functools
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any, Dict, List

import numpy
from rosidl_parser import parser

# Each of the generators below parses every definition, which takes most of their time.
parser.get_ast_from_idl_string = functools.lru_cache(None)(parser.get_ast_from_idl_string)

from rosidl_adapter.action import convert_action_to_idl
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl
from rosidl_cli.command.helpers import generate_visibility_control_file, generator_arguments_file, \
    legacy_generator_arguments
from rosidl_generator_c import generate_c
from rosidl_generator_py import generate_py
from rosidl_generator_type_description import generate_type_hash
from rosidl_typesupport_c import generate_c as generate_dispatch
from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
from rosidl_typesupport_introspection_c import generate_c as generate_introspection

#: Not on PyPI, and every program that follows frames needs it: package -> file -> text.
MORE = {"tf2_msgs": {"msg/TFMessage.msg": "geometry_msgs/TransformStamped[] transforms\n"}}
#: The services that the relay offers; each takes as long to compile as four messages.
SERVICES = ("PauseAt", "SetJointPositions", "SetReference", "SetTargetPose", "Step", "Teach")
CONVERTERS = {".msg": convert_msg_to_idl, ".srv": convert_srv_to_idl, ".action": convert_action_to_idl}
#: The first serializes, the second describes types; without it Fast DDS complains about each type.
TYPE_SUPPORTS = ("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c")
OPTIONS = ("-O1", "-w", "-fPIC", "-c")
PREFIX, SITE = Path(sys.prefix), Path(sysconfig.get_paths()["purelib"])


def main() -> int:
    """Builds every package. Returns the exit code."""
    for folder in map(Path, sys.argv[1:]):
        build(folder.name, {str(path.relative_to(folder)): ros2_text(path.read_text(encoding="utf-8"))
                            for path in sorted(folder.glob("*/*")) if path.suffix in CONVERTERS
                            and (path.suffix != ".srv" or path.stem in SERVICES)})
    for package, files in MORE.items():
        build(package, files)
    return 0


def ros2_text(text: str) -> str:
    """Returns the ROS 2 text of a ROS 1 definition."""
    lines = []
    for line in text.splitlines():
        found = re.fullmatch(r"([\w/]+)(\[\d*\])?(\s+)(\w+)(\s*=\s*)?([^#]*)(.*)", line)
        if found:
            kind, array, space, name, equals, value, comment = found.groups()
            kind = {"Header": "std_msgs/Header", "time": "builtin_interfaces/Time",
                    "duration": "builtin_interfaces/Duration"}.get(kind, kind)
            if equals and kind == "string":
                value, comment = f'"{(value + comment).strip()}"', ""
            line = f"{kind}{array or ''}{space}{name if equals else name.lower()}{equals or ''}{value}{comment}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def build(package: str, files: Dict[str, str]) -> None:
    """Writes the definitions, generates code, compiles it, and puts an importable package into the environment.

    Args: files: path in the package -> text of the definition.
    Raises: subprocess.CalledProcessError: the compiler failed; it has said why.
    """
    share = PREFIX / "share" / package
    for folder in (share, SITE / package):
        shutil.rmtree(folder, ignore_errors=True)
    for name, text in files.items():
        (share / name).parent.mkdir(parents=True, exist_ok=True)
        (share / name).write_text(text, encoding="utf-8")
        CONVERTERS[Path(name).suffix](share, package, Path(name), (share / name).parent)
    index = PREFIX / "share" / "ament_index" / "resource_index"
    (index / "packages" / package).touch()
    (index / "rosidl_interfaces" / package).write_text("\n".join(files), encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        code = Path(folder) / package
        generate(package, share, list(files), code)
        compile_library(package, code)
        (code / "__init__.py").touch()  # without it the ROS 1 package of this name would be imported
        for path in code.rglob("*.py"):
            target = SITE / path.relative_to(code.parent)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)


def generate(package: str, share: Path, files: List[str], code: Path) -> None:
    """Writes C and Python code of all interfaces into a folder."""
    include = PREFIX / "share"
    idl = [str(Path(name).with_suffix(".idl")) for name in files]

    def arguments(generator: str, code: Path = code, **more: Any) -> Any:
        templates = include / generator / "resource"
        for control in templates.glob(f"{generator}__visibility_control.h.in"):
            generate_visibility_control_file(package_name=package, template_path=control,
                                             output_path=code / "msg" / control.stem)
        return generator_arguments_file(**{**legacy_generator_arguments(
            package_name=package, interface_files=[f"{share}:{name}" for name in idl], include_paths=[str(include)],
            templates_path=str(templates), output_path=str(code)), **more})

    known = [f"{folder.name}:{folder}" for folder in include.iterdir() if (folder / "msg").is_dir()]
    with arguments("rosidl_generator_type_description", include_paths=known) as file:
        for path in generate_type_hash(file):
            shutil.copy(path, share / Path(path).relative_to(code))  # for packages that use these types
    described = [f"{name}:{code / Path(name).with_suffix('.json')}" for name in idl]
    sources = [str(share / name) for name in idl]
    with arguments("rosidl_generator_c", ros_interface_files=sources, type_description_tuples=described) as file:
        generate_c(file)
    with arguments(TYPE_SUPPORTS[0]) as file:
        generate_typesupport_fastrtps_c(file)
    with arguments(TYPE_SUPPORTS[1], code.parent / "introspection" / package) as file:
        generate_introspection(file)
    with arguments("rosidl_typesupport_c") as file:
        generate_dispatch(file, list(TYPE_SUPPORTS))
    with arguments("rosidl_generator_py") as file:
        generate_py(file, ["rosidl_typesupport_c"])


def compile_library(package: str, code: Path) -> None:
    """Compiles all that was generated as one library, which Python imports as the package's type support."""
    include = [f"-I{folder}" for folder in (
        code.parent, code.parent / "introspection", sysconfig.get_paths()["include"], numpy.get_include(),
        PREFIX / "include", *(PREFIX / "include").iterdir())]
    # Files of C++ compile faster as one; those of C have static names in common.
    whole, objects = code / "whole.cpp", code / "objects"
    whole.write_text("".join(f'#include "{path}"\n' for path in sorted(code.rglob("*.cpp"))), encoding="utf-8")
    objects.mkdir()
    running = []
    for name, compiler, files in (("whole", "g++", [whole]), ("code", "gcc", code.rglob("*.c")),
                                  ("introspection", "gcc", (code.parent / "introspection").rglob("*.c"))):
        (objects / name).mkdir()  # a folder each, because files of two folders have the same name
        running.append(subprocess.Popen([compiler, *OPTIONS, *sorted(map(str, files)), *include], cwd=objects / name))
    for process in running:
        process.wait()
    for process in running:
        if process.returncode:
            raise subprocess.CalledProcessError(process.returncode, process.args[0])
    libraries = [path.stem[len("lib"):] for pattern in ("rosidl_*_c", "*_msgs__rosidl_*_c", "*_interfaces__rosidl_*_c",
                                                        "*__rosidl_generator_py", "fastcdr", "rmw", "rcutils")
                 for path in sorted((PREFIX / "lib").glob(f"lib{pattern}.so"))]
    made = SITE / package / f"{package}_s__rosidl_typesupport_c.so"
    made.parent.mkdir()
    subprocess.run(["g++", "-shared", "-Wl,--as-needed", "-o", str(made), *map(str, objects.rglob("*.o")),
                    f"-L{PREFIX / 'lib'}", *(f"-l{name}" for name in libraries), "-lrosidl_typesupport_fastrtps_cpp",
                    "-lrcpputils"], check=True)
    for name in TYPE_SUPPORTS:  # the names by which it is looked for
        link = PREFIX / "lib" / f"lib{package}__{name}.so"
        link.unlink(missing_ok=True)
        link.symlink_to(made)


if __name__ == "__main__":
    sys.exit(main())
