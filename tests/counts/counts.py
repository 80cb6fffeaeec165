"""Counts the instructions of fixed pieces of work and compares them with the figures of counts.json.

    python3 tests/counts/counts.py            # count and compare; exit code 1 when a piece became slower
    python3 tests/counts/counts.py --renew    # write what was counted into counts.json

A busy machine changes times but not these counts, so that a piece that needs more is found on any machine. The
counts do depend on the compiler and on the libraries, whose versions stand in counts.json too. They come from
callgrind, of the frames that program.py runs.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FIGURES = HERE / "counts.json"
#: A piece may need this part more than its figure says.
ALLOWED = 0.05
#: Piece -> (function that callgrind sees, what its calls are divided by). "" is everything that is done in the frames.
PIECES = {
    "physics of a frame": ("aras_visual_servo_sim::Simulation::step(long)", "frames"),
    "a rendered frame": ("aras_visual_servo_sim::CoverageRenderer::doRender(", "frames"),
    "hashes of a frame": ("aras_visual_servo_sim::RunHash::add(void const*, unsigned long)", "frames"),
    "features of a frame": ("aras_visual_servo_camera::MomentExtractor::process(", "frames"),
    "a frame of the loop in process": ("", "frames"),
}
#: Functions with less than this part of all instructions are not kept: they cannot be what made a piece slower.
KEPT = 0.0005


def count():
    """{"pieces": {piece: instructions a frame}, "functions": {function: instructions a frame}} of program.py.

    Raises RuntimeError: callgrind or the program failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind"
        environment = dict(os.environ, PYTHONHASHSEED="0", OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1",
                           OPENCV_OPENCL_RUNTIME="disabled")
        program = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--compress-pos=no",
             "--zero-before=aras_visual_servo_sim::Simulation::reset()",
             "--dump-before=aras_visual_servo_sim::RunHash::hex*",
             sys.executable, str(HERE / "program.py")], env=environment, capture_output=True, text=True)
        parts = sorted(pathlib.Path(folder).glob("callgrind.*"))
        if program.returncode or not parts:
            raise RuntimeError(f"callgrind ended with {program.returncode}:\n{program.stderr[-2000:]}")
        run_hash, status, ticks, frames = program.stdout.split()
        if status != "SERVOING":
            raise RuntimeError(f"the frames that are counted end as {status}, allowed SERVOING")
        exclusive, inclusive = costs_of(parts[0].read_text())
    frames = int(frames)
    total = sum(exclusive.values())
    pieces = {piece: sum(n for name, n in inclusive.items() if name.startswith(function)) if function else total
              for piece, (function, _) in PIECES.items()}
    missing = [piece for piece, n in pieces.items() if n == 0]
    if missing:
        raise RuntimeError(f"callgrind saw no call of {', '.join(PIECES[piece][0] for piece in missing)}")
    return {"pieces": {piece: round(n / frames) for piece, n in pieces.items()},
            "functions": {name: round(n / frames) for name, n in exclusive.items() if n > KEPT * total}}


def costs_of(text):
    """({function: its own instructions}, {function: those with everything that it calls}) of a file of callgrind."""
    names, own, inclusive, function, library, called = {}, {}, {}, "", "", False
    for line in text.splitlines():
        key, _, value = line.partition("=")
        if key in ("fn", "ob", "cfn", "cob"):  # a name stands where its number comes first
            number, _, name = value.partition(" ")
            name = names.setdefault((key[-2:], number), name)
            library = name if key == "ob" else library
            function = function_of(name, library) if key == "fn" else function
        elif key == "calls":
            called = True
        elif line[:1].isdigit() or line[:1] in ("+", "-", "*"):
            cost = int(line.split()[1])
            inclusive[function] = inclusive.get(function, 0) + cost
            if not called:
                own[function] = own.get(function, 0) + cost
            called = False
    return own, inclusive


def function_of(name, library):
    """The function without marks of recursion; one without a name is called by its library."""
    unnamed = re.fullmatch(r"0x[0-9a-f]+", name)
    return f"unnamed in {pathlib.PurePath(library).name}" if unnamed else re.sub(r"'\d+$", "", name)


def made_with():
    """{name: version} of what the counts depend on."""
    def first_line(*command):
        return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0].strip()

    packages = ["libbullet3.24", "libeigen3-dev", "libvisp-dev", "libopencv-dev", "liborocos-kdl1.5", "libblas3",
                "liblapack3", "libc6", "python3-numpy", "python3.11", "valgrind"]
    versions = {"compiler": first_line("c++", "--version")}
    for package in packages:
        found = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
        versions[package] = found.stdout.strip() or "none"
    flags = pathlib.Path("/proc/cpuinfo").read_text().split()
    versions["processor"] = " ".join(flag for flag in ("avx2", "fma", "erms") if flag in flags)
    return versions


def compare(figures, found, versions):
    """What became slower, a line each; [] if nothing did.

    Args: figures: of counts.json.  found: of `count`.  versions: of `made_with`.
    """
    slower = [(piece, n, found["pieces"][piece]) for piece, n in figures["pieces"].items()
              if found["pieces"][piece] > (1.0 + ALLOWED) * n]
    lines = [f"{piece}: found {now:,} instructions, allowed {n:,} and {100 * ALLOWED:.0f} % more; this is "
             f"{100 * (now / n - 1):.1f} % more" for piece, n, now in slower]
    if not lines:
        return []
    before = figures["functions"]
    grown = sorted(((now - before.get(name, 0), name) for name, now in found["functions"].items()), reverse=True)[:3]
    lines.append("grown most, instructions a frame: "
                 + "; ".join(f"{name} by {more:,} to {found['functions'][name]:,}" for more, name in grown if more > 0))
    other = other_versions(figures, versions)
    if other:
        lines.append(f"other versions than those of the figures, which may be the cause: {', '.join(other)}; if so, "
                     "python3 tests/counts/counts.py --renew")
    return lines


def other_versions(figures, versions):
    """What the figures were counted with and this machine has not: a list of "NAME WAS -> IS"."""
    return [f"{name} {was} -> {versions.get(name, 'none')}" for name, was in figures["made_with"].items()
            if versions.get(name, "none") != was]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--renew", action="store_true", help="write what was counted into counts.json")
    arguments = parser.parse_args()
    found, versions = count(), made_with()
    for piece, n in found["pieces"].items():
        print(f"{piece:<34}{n:>12,} instructions")
    if arguments.renew:
        FIGURES.write_text(json.dumps({"made_with": versions, **found}, indent=1) + "\n")
        return 0
    slower = compare(json.loads(FIGURES.read_text()), found, versions)
    print("\n".join(slower))
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
