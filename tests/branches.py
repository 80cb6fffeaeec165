"""Prints the share of branches that the unit tests take, by package and room; fails when a core is below LEAST.

    python3 tests/branches.py BUILD FILE      # script/test coverage runs this

BUILD holds the C++ cores, compiled by clang with -fcoverage-mapping, and the counts of the unit tests in both languages
(*.profraw). FILE is the data file of coverage.py. Nodes and bindings are not counted: rostests and Python test them.
A C++ branch is one outcome of a condition in the source; each operand of && and || counts by itself. A function in a
header counts once, and a template as the instance of which the tests take most.
"""
import collections
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
LEAST = 0.90
CORES = ("aras_visual_servo_common (C++)", "aras_visual_servo_sim (C++)", "aras_visual_servo_camera (C++)",
         "aras_visual_servo (Python)", "aras_visual_servo_study (Python)")
#: Rooms that wire a core to ROS or to Python.
WIRING = ("nodes", "ros", "bindings", "python")


def of_cpp(build: pathlib.Path):
    """Yields (package, room, branches taken, branches) of each file of the C++ cores."""
    counts = build / "counts.profdata"
    subprocess.run(["llvm-profdata", "merge", "-o", counts, *build.glob("*.profraw")], check=True)
    library, *others = build.glob("*/devel/lib/*.so")
    said = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={counts}", library,
                           *(f"-object={other}" for other in others),
                           *ROOT.glob("src/*/src"), *ROOT.glob("src/*/include")], check=True, stdout=subprocess.PIPE)
    for file in json.loads(said.stdout)["data"][0]["files"]:
        _, package, *parts = pathlib.Path(file["filename"]).relative_to(ROOT).parts
        inside = parts[2:] if parts[:2] == ["src", "core"] or parts[0] == "include" else parts[1:]
        branches = file["summary"]["branches"]
        yield f"{package} (C++)", inside[0] if inside[1:] else "", branches["covered"], branches["count"]


def of_python(file: str):
    """Yields the same of each module of the Python packages."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "coverage.json"
        subprocess.run(["python3", "-m", "coverage", "json", "-q", f"--data-file={file}", "-o", out], check=True)
        files = json.loads(out.read_text())["files"]
    for name, each in files.items():
        parts = pathlib.PurePath(name).parts
        package, *inside = parts[parts.index("dist-packages") + 1:]
        if (ROOT / "src" / package / "src" / package).is_dir():  # messages are generated
            yield (f"{package} (Python)", inside[0] if inside[1:] else "", each["summary"]["covered_branches"],
                   each["summary"]["num_branches"])


def main(build: str, file: str) -> int:
    """Prints the table. Returns 1 when a core is below LEAST."""
    found = collections.defaultdict(lambda: [0, 0])
    for package, room, taken, branches in (*of_cpp(pathlib.Path(build)), *of_python(file)):
        for name in () if room in WIRING else (room or "-", "~ all"):
            found[package, name][0] += taken
            found[package, name][1] += branches
    low = []
    for (package, room), (taken, branches) in sorted(found.items()):
        if branches:
            print(f"{package:40} {room:15} {100.0 * taken / branches:6.1f} % {branches:6}")
        if room == "~ all" and package in CORES and taken < LEAST * branches:
            low.append(package)
    for package in low:
        print(f"branches: {package}: found less than {100 * LEAST:.0f} % of the branches taken, allowed more")
    return int(bool(low))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
