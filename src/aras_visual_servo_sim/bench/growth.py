#!/usr/bin/env python3
"""How the cost of images and of robots grows: prints tables, and draws them.

    growth.py [cameras|pixels|triangles|robots ...] [--runs 5] [--figure FILE.png]

cameras      1 to 8 cameras of 640 x 480 on 1, 2, 4 and 8 cores, as many as there are: simulated over wall seconds,
             all of them due together at 30 Hz
pixels       one image from 160 x 120 to 1920 x 1080: the arm over a table with shadows and four samples, milliseconds
             of processor time
triangles    one body of 10^2 to 10^6 triangles in an image of 800 x 800, and the same where none are put together
             (a picture lies on it): milliseconds of processor time of the first image and of each further one
robots       1 to 50 arms of six joints with their controllers, through the packages of Gazebo's names: simulated
             seconds per second of processor time
The least of all runs counts. Each figure is measured in a process of its own.
"""
import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
MANY_ROBOTS = HERE.parents[2] / "gazebo" / "gazebo_ros" / "bench" / "many_robots.py"
CAMERAS, SIZES = (1, 2, 3, 4, 6, 8), ((160, 120), (320, 240), (640, 480), (800, 800), (1280, 720), (1920, 1080))
TRIANGLES, ROBOTS = (100, 1000, 10000, 100000, 1000000), (1, 2, 5, 10, 20, 50)
CORES = [n for n in (1, 2, 4, 8) if n <= len(os.sched_getaffinity(0))]


def cameras(count, cores):
    """Simulated over wall seconds of this many cameras on this many cores."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:cores])  # before threads begin
    from aras_visual_servo_sim import Simulation
    config = {"cameras": [{"name": "camera%d" % k, "frame": "camera_optical_frame", "width": 640, "height": 480,
                           "rate_hz": 30.0, "fx_px": 390.0, "fy_px": 390.0, "renderer": "opengl"}
                          for k in range(count)],
              "scene": {"lighting": {"lights": [{"name": "sun", "type": "directional", "direction": [0.3, 0.2, -1.0],
                                                 "casts_shadows": True}]},
                        "solids": [{"name": "floor", "box_m": [3.0, 4.0, 0.02], "position_m": [0.0, 0.0, 0.18],
                                    "material": {"casts_shadows": False}}]}}
    simulation = Simulation("package://aras_description/urdf/aras_arm.urdf", config)
    wanted = [(camera["name"], True, False) for camera in config["cameras"]]

    def take(images):
        for _ in range(images):
            simulation.step((simulation.next_image_ns("camera0") - simulation.time_ns) // 1000000)
            simulation.take_frames(wanted)

    take(3)  # the first make shaders
    begun = time.perf_counter()
    take(20)
    return 20 / 30.0 / (time.perf_counter() - begun)


def pixels(width, height):
    """Milliseconds of processor time of an image of the arm, everything on."""
    os.environ["LP_NUM_THREADS"] = "0"
    from cameras import frames_per_s, simulation_of
    with tempfile.TemporaryDirectory() as folder:
        simulation, joints = simulation_of("arm_everything", (width, height), folder)
        return 1000.0 / frames_per_s(simulation, joints, 1.0, False)


def ball(folder, triangles, textured):
    """An uneven ball of about so many triangles; returns its file."""
    rings = max(3, round(math.sqrt(triangles / 4.0)))
    sides = 2 * rings
    lines = ["mtllib ball.mtl", "usemtl m"] if textured else []
    for k in range(rings + 1):
        for i in range(sides):
            polar, around = math.pi * k / rings, 2.0 * math.pi * i / sides
            radius = 0.5 * (1.0 + 0.05 * math.sin(9.0 * polar) * math.sin(7.0 * around))
            lines.append("v %.7f %.7f %.7f" % (radius * math.sin(polar) * math.cos(around),
                                               radius * math.sin(polar) * math.sin(around), radius * math.cos(polar)))
            if textured:
                lines.append("vt %.5f %.5f" % (i / sides, k / rings))
    corner = "%d/%d" if textured else "%d"

    def face(*indices):
        return "f " + " ".join(corner % ((i, i) if textured else i) for i in indices)

    for k in range(rings):
        for i in range(sides):
            a, b = k * sides + i + 1, k * sides + (i + 1) % sides + 1
            lines += [face(a, a + sides, b + sides), face(a, b + sides, b)]
    path = pathlib.Path(folder, "ball.obj")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    if textured:
        from cameras import write_png
        write_png(str(path.with_name("ball.png")), 64, lambda u, v: bytes((4 * u, 4 * v, 128)))
        path.with_name("ball.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd ball.png\n", encoding="ascii")
    return str(path)


def triangles(count, textured):
    """Milliseconds of processor time of an image of a body: the first, and each further one."""
    os.environ["LP_NUM_THREADS"] = "0"
    from aras_visual_servo_sim import Simulation
    from cameras import BESIDE
    with tempfile.TemporaryDirectory() as folder:
        config = {"cameras": [{"name": "camera", "frame": "eye", "width": 800, "height": 800, "renderer": "opengl",
                               "fx_px": 500.0, "fy_px": 500.0, "far_m": 20.0}],
                  "scene": {"solids": [{"name": "ball", "mesh": ball(folder, count, textured),
                                        "position_m": [0.0, 0.0, 0.3]}]}}
        simulation = Simulation(BESIDE, config)
        times = []
        for _ in range(8):
            begun = time.process_time()
            simulation.render("camera")
            times.append(1000.0 * (time.process_time() - begun))
        return times[0], min(times[1:])


def measure(what, *arguments):
    """A figure, measured in a process of its own."""
    output = subprocess.run([sys.executable, __file__, "--figure-of", what, json.dumps(arguments)], check=True,
                            capture_output=True, text=True).stdout
    return json.loads(output.splitlines()[-1])


def least(values):
    """The least of each of several figures that were measured together."""
    return [min(column) for column in zip(*values)]


def table(rows):
    """Prints rows of cells, the first of them the heading."""
    for row in rows:
        print("| " + " | ".join(cell if isinstance(cell, str) else "%.3g" % cell for cell in row) + " |")
    print(flush=True)


def robots(count):
    """Simulated seconds per second of processor time."""
    output = subprocess.run([sys.executable, MANY_ROBOTS, "--arms", str(count), "--seconds", "1"], check=True,
                            capture_output=True, text=True).stdout
    return float(re.search(r"([\d.]+) simulated seconds per CPU second", output).group(1))


def grow(what, runs):
    """One table. Returns (what is counted, unit, {label: {count: figure}})."""
    curves = {}
    if what == "cameras":
        for cores in CORES:
            curves["%d core%s" % (cores, "s" * (cores > 1))] = {
                count: max(measure(what, count, cores) for _ in range(runs)) for count in CAMERAS}
        return "cameras of 640 x 480, 30 Hz", "simulated / wall seconds", curves
    if what == "pixels":
        curves["arm, shadows, four samples"] = {
            1e-6 * width * height: min(measure(what, width, height) for _ in range(runs)) for width, height in SIZES}
        return "megapixels", "ms an image", curves
    if what == "triangles":
        for label, textured in (("", False), (", with a picture", True)):
            for count in TRIANGLES:
                first, further = least([measure(what, count, textured) for _ in range(runs)])
                curves.setdefault("further images" + label, {})[count] = further
                curves.setdefault("first image" + label, {})[count] = first
        return "triangles of a body", "ms an image", curves
    curves["arms of six joints"] = {count: max(robots(count) for _ in range(runs)) for count in ROBOTS}
    return "robots", "simulated / processor seconds", curves


def draw(found, path):
    """A panel for each table, both axes logarithmic."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator
    figure, axes = plt.subplots(1, len(found), figsize=(4.2 * len(found), 3.6), squeeze=False)
    for axis, (of_what, unit, curves) in zip(axes[0], found):
        for label, curve in curves.items():
            axis.loglog(list(curve), list(curve.values()), marker="o", markersize=4, linewidth=1.5, label=label)
        axis.set_xlabel(of_what)
        axis.set_ylabel(unit)
        words = ["%.2g" % count if count < 100 else ("%.0e" % count).replace("e+0", "e") for count in curve]
        axis.set_xticks(list(curve), words, fontsize=7)
        axis.xaxis.set_minor_locator(NullLocator())
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "%g" % value))
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.grid(True, which="both", linewidth=0.4, color="0.88")
        axis.set_axisbelow(True)
        if len(curves) > 1:
            axis.legend(fontsize=8, frameon=False)
        axis.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", metavar="WHAT", help="cameras, pixels, triangles, robots; default: all")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--figure", help="PNG or SVG file to draw them into")
    parser.add_argument("--figure-of", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.figure_of:
        name, arguments = options.figure_of
        print(json.dumps({"cameras": cameras, "pixels": pixels, "triangles": triangles}[name](*json.loads(arguments))))
        return
    known = ("cameras", "pixels", "triangles", "robots")
    unknown = [what for what in options.what if what not in known]
    if unknown:
        parser.error("%s: not known; there are %s" % (", ".join(unknown), ", ".join(known)))
    found = []
    for what in options.what or known:
        of_what, unit, curves = grow(what, options.runs)
        found.append((of_what, unit, curves))
        counts = list(next(iter(curves.values())))
        table([[of_what, *("%g" % count for count in counts)], ["---"] * (len(counts) + 1),
               *([label + ": " + unit, *curve.values()] for label, curve in curves.items())])
    if options.figure:
        draw(found, options.figure)


if __name__ == "__main__":
    main()
