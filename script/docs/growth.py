"""Measures how cost grows, and writes docs/performance.md with its pictures; `script/bench --growth` runs it.

Every figure is processor time of one thread (time.process_time), the least of some repetitions, so that a busy machine
changes it little. Only the runs over ROS and those of workers are measured by the clock, since they use all cores.
"""
import argparse
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

import numpy as np

from aras_visual_servo_camera import MomentExtractor
from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo.runs.record import RecordBuilder
from aras_visual_servo.scenario.scenario import load_scenario
from aras_visual_servo_study.sweep.local import run_local
from aras_visual_servo_sim import Simulation

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(WORKSPACE / "src/aras_visual_servo_sim/bench"), str(WORKSPACE / "script/docs")]
import rates  # noqa: E402: scenes and gains of the other benchmarks
from growth_page import Measured, draw_budget, draw_growth, page  # noqa: E402

REPETITIONS, SECONDS = 5, 0.15
#: The longer of two runs over ROS servos that much longer [s].
LONGER_S = 200.0
#: By about so much the processor time of two starts of one process differs [s].
STARTS_S = 0.1
CAMERA = {"name": "camera", "frame": "camera_optical_frame", "width": 320, "height": 240, "horizontal_fov_rad": 1.41}
START = {"gantry": 0.05}
DARK = {"object": "dark", "segmentation": "coverage"}


def cost_us(work, seconds=SECONDS):
    """Least processor time of one call of work() [us]."""
    work()
    calls, least = 1, math.inf
    for _ in range(REPETITIONS):
        while True:
            begin = time.process_time()
            for _ in range(calls):
                work()
            used = time.process_time() - begin
            if used >= seconds / REPETITIONS or calls > 10**6:
                break
            calls *= 2
        least = min(least, used / calls)
    return 1e6 * least


# --- what grows -------------------------------------------------------------------------------------------------------

def chain(joints):
    """(URDF, controllers) of an arm of so many joints, which turn about x and y in turn."""
    parts = ['<robot name="chain"><link name="base"/>']
    for k in range(joints):
        axis = "1 0 0" if k % 2 else "0 1 0"
        parts.append(
            f'<link name="l{k}"><inertial><mass value="0.2"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" '
            f'iyz="0"/></inertial></link><joint name="j{k:02d}" type="revolute"><parent link="'
            f'{"base" if k == 0 else f"l{k - 1}"}"/><child link="l{k}"/><origin xyz="0 0 -0.05"/><axis xyz="{axis}"/>'
            '<limit lower="-2" upper="2" effort="100" velocity="5"/><dynamics damping="0.5"/></joint>')
    pid = {"p": 20.0, "i": 1.0, "d": 1.0, "i_clamp": 10.0}
    controllers = {f"j{k:02d}": {"type": "effort_controllers/JointPositionController", "joint": f"j{k:02d}", "pid": pid}
                   for k in range(joints)}
    return "".join(parts) + "</robot>", controllers


def physics_of(joints):
    urdf, controllers = chain(joints)
    sim = Simulation(urdf, {}, controllers)
    sim.step(50)
    return cost_us(lambda: sim.step(20)) / 20


def contacts_of(boxes):
    solids = [{"name": f"box{k}", "box_m": [0.1, 0.1, 0.1], "mass_kg": 0.5,
               "position_m": [0.2 * (k % 8), 1.0 + 0.2 * (k // 8), 0.05]} for k in range(boxes)]
    urdf, controllers = chain(6)
    sim = Simulation(urdf, {"scene": {"solids": solids}, "contacts": {"ground_plane": {"friction": 0.5}}}, controllers)
    sim.step(200)
    return cost_us(lambda: sim.step(20)) / 20


def simulation(scene, **camera):
    return Simulation(rates.ARM, {"scene": scene, "cameras": [{**CAMERA, **camera}], "initial_positions": START},
                      rates.published_controllers())


def render_of(scene, **camera):
    sim = simulation(scene, **camera)
    return cost_us(lambda: sim.render("camera"))


def size_of(pixels):
    width, height = pixels
    sim = simulation(rates.scene_of("plane"), width=width, height=height)
    image = np.array(sim.render("camera"))
    extractor = MomentExtractor(sim.camera_info("camera"), DARK)
    return cost_us(lambda: sim.render("camera")), cost_us(lambda: extractor.process(image))


def cameras_of(count):
    cameras = [{**CAMERA, "name": f"camera{k}", "rate_hz": 30.0} for k in range(count)]
    sim = Simulation(rates.ARM, {"scene": rates.scene_of("plane"), "cameras": cameras, "initial_positions": START},
                     rates.published_controllers())

    def frame():
        for camera in cameras:
            sim.step_to_image(camera["name"])
            sim.frame(camera["name"])
    return cost_us(frame)


def targets_of(count):
    target = {"file": "package://aras_description/targets/rectangle.yaml"}
    models = rates.scene_of("plane")["models"][:1]
    for k in range(count):
        x, y = 0.03 + 0.06 * (k % 8 - 4), 0.05 + 0.06 * (k // 8 - 2)
        models.append({"name": f"target{k}", "position_m": [x, y, rates.TABLE_Z_M + 0.001], **target})
    return render_of({"models": models})


def triangles_of(count):
    """A round hill of about so many triangles, a fifth of the image."""
    n = max(2, round(math.sqrt(count / 2)))
    xs = np.linspace(-0.1, 0.1, n + 1)
    z = 0.05 * np.cos(np.pi * xs / 0.2)
    triangles = []
    for i in range(n):
        for j in range(n):
            corner = [(xs[a], xs[b], z[a] * z[b] / 0.05) for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
            triangles += [(corner[0], corner[1], corner[2]), (corner[0], corner[2], corner[3])]
    with tempfile.NamedTemporaryFile(suffix=".stl") as file:
        file.write(bytes(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0.0, 0.0, 0.0, *[float(x) for point in triangle for x in point], 0))
        file.flush()
        solid = {"name": "hill", "mesh": file.name, "position_m": [0.03, 0.05, rates.TABLE_Z_M]}
        return render_of({**rates.scene_of("plane"), "solids": [solid]})


def pretend(run_s, starts):
    """What a worker of the simulated cluster does: it is busy as long as the runs would take on a core of its own."""
    time.sleep(run_s * len(starts))
    return [({"id": start}, run_s) for start in starts]


def workers_of(count, run_s, runs):
    """Runs a second."""
    done = []
    chunks = [list(range(i, min(i + 8, runs))) for i in range(0, runs, 8)]
    begin = time.perf_counter()
    run_local(pretend, run_s, chunks, count, 1, done.extend, done.append)
    assert len(done) == runs
    return runs / (time.perf_counter() - begin)


#: Title, what is counted, unit of the cost, counts, what measures the cost.
SERIES = (
    ("Joints of an arm", "joints", "us a physics step of 1 ms", (6, 12, 18, 24, 36, 48, 60), physics_of),
    ("Boxes that rest on the ground, four contact points each", "boxes", "us a physics step of 1 ms",
     (0, 1, 2, 4, 8, 16), contacts_of),
    ("Cameras of 320 x 240 at 30 Hz", "cameras", "us a frame of all, physics included", (1, 2, 3, 4, 6, 8), cameras_of),
    ("Flat targets in the image, 320 x 240", "targets", "us an image", (1, 2, 4, 8, 16, 32), targets_of),
    ("Triangles of a mesh in the image, 320 x 240", "triangles", "us an image", (32, 128, 512, 2048, 8192, 32768),
     triangles_of),
)
SIZES = ((160, 120), (320, 240), (640, 480), (1280, 720), (1920, 1080))
WORKERS = (1, 2, 3, 4, 6, 8)


# --- the budget of a frame --------------------------------------------------------------------------------------------

def budget_in_process(runs):
    """({part: us a frame}, us a frame of the whole loop), medians over runs of experiment_1."""
    scenario, clock = load_scenario("experiment_1"), time.process_time
    parts, wholes = [], []
    for _ in range(runs):
        loop = ServoLoop(scenario)
        loop.run()
        wholes.append(1e6 * timed(lambda loop=ServoLoop(scenario): loop.run()) / (loop.frame + 1))
        loop, used = ServoLoop(scenario), {}

        def watched(name, function, used=used):
            def call(*arguments, **more):
                begin = clock()
                try:
                    return function(*arguments, **more)
                finally:
                    used[name] = used.get(name, 0.0) + clock() - begin
            return call

        class Sim:
            """The simulator with a clock at each door."""

            def __init__(self, sim):
                self._sim = sim
                self.step_to_image = watched("physics", sim.step_to_image)
                self.frame = watched("image and its hash", sim.frame)
                self.set_command = watched("command", sim.set_command)

            def __getattr__(self, name):
                return getattr(self._sim, name)

        loop.sim = Sim(loop.sim)
        loop._see = watched("features", loop._see)
        loop.sequence.step = watched("sequence and servo", loop.sequence.step)
        add, RecordBuilder.add_answer = RecordBuilder.add_answer, watched("record", RecordBuilder.add_answer)
        try:
            loop.run()
        finally:
            RecordBuilder.add_answer = add
        parts.append({name: 1e6 * seconds / (loop.frame + 1) for name, seconds in used.items()})
    return {name: float(np.median([one[name] for one in parts])) for name in parts[0]}, float(np.median(wholes))


def timed(work):
    begin = time.process_time()
    work()
    return time.process_time() - begin


def processor_s(root):
    """{name of a process: processor time [s]} of a process and all that it started."""
    tick, found, parents = os.sysconf("SC_CLK_TCK"), {}, {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            name, fields = (folder / "stat").read_text().rsplit(")", 1)
            words = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        fields, pid = fields.split(), int(folder.name)
        script = next((pathlib.PurePath(word.decode()).name for word in words[:2] if not word.endswith(b"python3")), "")
        parents[pid] = int(fields[1]), script or name.partition("(")[2], (int(fields[11]) + int(fields[12])) / tick
    for pid, (_, name, used) in parents.items():
        above = pid
        while above in parents and above != root:
            above = parents[above][0]
        if above == root:
            found[f"{name} {pid}"] = name, used
    return found


def budget_over_ros():
    """{process: us a frame} over ROS with its bag: what a longer run uses more until its bag is closed.

    So starting and the report do not count.
    """
    def run(servo_s, folder):
        process = subprocess.Popen(["rosrun", "aras_visual_servo_controller", "run", "experiment_1", "--output", folder,
                                    "--set", f"servo.time_limit_s={servo_s}", "--set", "servo.thresholds.xn=1.0e-12"],
                                   stdout=subprocess.DEVNULL)  # it never converges and ends at its time limit
        seen = {}
        while process.poll() is None:
            if not any(pathlib.Path(folder).rglob("run.bag")):
                seen.update(processor_s(process.pid))
            time.sleep(0.02)
        used = {}
        for name, seconds in seen.values():
            used[name] = used.get(name, 0.0) + seconds
        summary = json.loads(next(pathlib.Path(folder).rglob("summary.json")).read_text())
        return used, summary["images"]

    with tempfile.TemporaryDirectory() as short, tempfile.TemporaryDirectory() as long:
        (before, few), (after, many) = run(3.0, short), run(3.0 + LONGER_S, long)
    more = {name: seconds - before.get(name, 0.0) for name, seconds in after.items()}
    return {name: 1e6 * s / (many - few) for name, s in sorted(more.items(), key=lambda item: -item[1]) if s > STARTS_S}


# --- the command -----------------------------------------------------------------------------------------------------

def machine_name():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    name = next((line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name")), "?")
    return f"{os.cpu_count()} cores of {name}"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few points and no ROS, to try the program")
    parser.add_argument("--no-ros", action="store_true", help="without the runs over ROS")
    parser.add_argument("--output", type=pathlib.Path, default=WORKSPACE / "docs", metavar="DIR",
                        help="folder of performance.md and images/ (default: docs)")
    options = parser.parse_args(arguments)
    keep = (lambda values: values[:2]) if options.quick else (lambda values: values)
    series = []
    for title, what, unit, counts, measure in SERIES:
        costs = [measure(count) for count in keep(counts)]
        series.append((title, what, unit, list(keep(counts)), costs))
        print(f"{title} [{unit}]: " + ", ".join(f"{n}: {cost:.3g}" for n, cost in zip(counts, costs)), flush=True)
    sizes = {size: size_of(size) for size in keep(SIZES)}
    parts, whole_us = budget_in_process(1 if options.quick else 5)
    run_s, runs = 0.02, 80 if options.quick else 480
    workers = {count: workers_of(count, run_s, runs) for count in keep(WORKERS)}
    frames = {"in process": parts}
    if not (options.quick or options.no_ros):
        frames["over ROS"] = budget_over_ros()
    (options.output / "images").mkdir(parents=True, exist_ok=True)
    measured = Measured(series, sizes, workers, frames, whole_us, machine_name(), REPETITIONS)
    draw_growth(measured, options.output / "images/growth.png")
    draw_budget(frames, options.output / "images/frame_budget.png")
    (options.output / "performance.md").write_text(page(measured))
    print(f"written: {options.output / 'performance.md'}")


if __name__ == "__main__":
    sys.exit(main())
