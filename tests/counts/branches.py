"""Prints which part of the branches the unit tests take, by package and room, and fails below LEAST in a core.

    python3 tests/counts/branches.py BUILD FILE      # called by script/test coverage, see there

BUILD holds the C++ cores, compiled by clang with -fcoverage-mapping, and the counts that the unit tests of both
languages left there (*.profraw). FILE is what coverage.py wrote meanwhile. Nodes and bindings are not counted: they
are tested in a graph of ROS and from Python.
A branch of C++ is one way that a condition of the source goes, each operand of && and || by itself; what the compiler
adds, as clean-up for exceptions, is none. A function in a header counts once, however many programs hold it, and a
template as that one of its instances of which the tests take most; one that nobody instantiates does not count. The
functions that llvm-cov calls mismatched are those of headers, in files that include and do not use them.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Part of the branches of a core that has to be taken.
LEAST = 0.90
CORES = ("aras_visual_servo_common (C++)", "aras_visual_servo_sim (C++)", "aras_visual_servo_camera (C++)",
         "aras_visual_servo_controller (Python)")
#: Rooms that are no core: they are wiring to ROS.
WIRING = ("nodes", "ros", "bindings", "python")


def of_cpp(build):
    """{(package, room): (branches taken, branches)} of the cores in C++."""
    found, counts = {}, build / "counts.profdata"
    subprocess.run(["llvm-profdata", "merge", "-o", counts, *build.glob("*.profraw")], check=True)
    library, *others = build.glob("*/devel/lib/*.so")
    said = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={counts}", library,
                           *(f"-object={other}" for other in others),
                           *ROOT.glob("src/*/src"), *ROOT.glob("src/*/include")], check=True, stdout=subprocess.PIPE)
    for file in json.loads(said.stdout)["data"][0]["files"]:
        package, room = _place(pathlib.Path(file["filename"]).relative_to(ROOT).parts)
        if room in WIRING:
            continue
        branches = file["summary"]["branches"]
        _add(found, package + " (C++)", room, branches["covered"], branches["count"])
    return found


def _place(parts):
    """(package, room) of src/PACKAGE/src/core/ROOM/..., src/PACKAGE/include/PACKAGE/ROOM/... or src/PACKAGE/src/..."""
    inside = parts[4:] if parts[2:4] == ("src", "core") or parts[2] == "include" else parts[3:]
    return parts[1], inside[0] if len(inside) > 1 else ""


def of_python(file):
    """The same of the Python packages."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "coverage.json"
        subprocess.run(["python3", "-m", "coverage", "json", "-q", f"--data-file={file}", "-o", out], check=True)
        for name, each in json.loads(out.read_text())["files"].items():
            parts = pathlib.PurePath(name).parts
            package, *inside = parts[parts.index("dist-packages") + 1:]
            room = inside[0] if len(inside) > 1 else ""
            written_here = any(ROOT.glob(f"*/{package}/src/{package}"))  # messages are generated
            if written_here and room not in WIRING:
                _add(found, package + " (Python)", room, each["summary"]["covered_branches"],
                     each["summary"]["num_branches"])
    return found


def _add(found, package, room, taken, branches):
    before = found.get((package, room), (0, 0))
    found[package, room] = before[0] + taken, before[1] + branches


def report(found):
    """Lines of the table, and the cores that are below LEAST."""
    lines, low = ["package                                   room             taken    of"], []
    for package in sorted({package for package, _ in found}):
        rooms = {room: each for (name, room), each in found.items() if name == package and each[1]}
        if not rooms:
            continue
        whole = tuple(map(sum, zip(*rooms.values())))
        for room, (taken, branches) in [*sorted(rooms.items()), ("all", whole)]:
            lines.append(f"{package:40} {room or '-':15} {100.0 * taken / branches:6.1f} % {branches:6}")
        if package in CORES and whole[0] < LEAST * whole[1]:
            low.append(package)
    return lines, low


def main(build, file):
    lines, low = report({**of_cpp(pathlib.Path(build)), **of_python(file)})
    print("\n".join(lines))
    for package in low:
        print(f"branches: {package}: found less than {100 * LEAST:.0f} % of the branches taken, allowed more")
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
