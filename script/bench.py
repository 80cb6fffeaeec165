"""The figures of README.md: accuracy, determinism, speed. Prints one table; run it through script/bench."""
import argparse
import hashlib
import json
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

WORKSPACE = pathlib.Path(__file__).resolve().parents[1]
# google-benchmark executables, and the rows of theirs that stand in the table: (program, row, what it is)
MICRO = (
    ("build/aras_visual_servo_sim/physics_bench", "physics"),
    ("build/aras_visual_servo_sim/render_bench", "camera"),
    ("build/aras_visual_servo_camera/aras_visual_servo_camera_bench", "features"),
)


def row(what, value, note=""):
    print(f"{what:<58} {value:>22}  {note}", flush=True)


def calibration_ms():
    data, times = bytes(4 << 20), []
    for _ in range(9):
        start = time.perf_counter()
        hashlib.sha256(data).digest()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def accuracy(names):
    from aras_visual_servo_controller.experiment import judge, run_in_process
    from aras_visual_servo_controller.scenario import load_scenario

    for name in names:
        result = judge(run_in_process(load_scenario(name)))
        error = result.final_error
        row(f"{name}: |x|, |y|, |z| [mm], angle [deg]",
            "%.3f %.3f %.3f %.4f" % (abs(error["x_mm"]), abs(error["y_mm"]), abs(error["z_mm"]), error["angle_deg"]),
            f"{'converged' if result.converged else 'NOT CONVERGED'} in {result.duration_s:.2f} s simulated")
        if result.gains_per_s:
            shares = [abs(rate / result.gains_per_s[key] - 1.0) for key, rate in result.decay_per_s.items()
                      if rate == rate]
            row(f"{name}: decay against lambda, largest deviation", f"{100 * max(shares):.1f} %")


def loop_factor():
    from aras_visual_servo_controller.loop import ServoLoop
    from aras_visual_servo_controller.scenario import load_scenario

    loop = ServoLoop(load_scenario("experiment_1"))
    record = loop.run()
    return record.real_time_factor, record.run_hash


def in_process(runs, beside):
    factors, hashes, others = [], set(), []
    for _ in range(runs):   # in turn, so that a machine that slows down slows both
        factor, run_hash = loop_factor()
        factors.append(factor)
        hashes.add(run_hash)
        if beside:
            output = subprocess.run(shlex.split(beside), check=True, capture_output=True, text=True).stdout
            others.append(float(output.split()[-1]))
    row("whole loop in process, simulated / wall seconds, one core", f"{statistics.median(factors):.1f}",
        f"[{min(factors):.1f} .. {max(factors):.1f}] of {runs} runs")
    if others:
        ratios = [ours / other for ours, other in zip(factors, others)]
        row("  the program beside it", f"{statistics.median(others):.1f}", f"[{min(others):.1f} .. {max(others):.1f}]")
        row("  ours / its, run by run", f"{statistics.median(ratios):.2f}")
    row("in process, distinct run hashes", f"{len(hashes)}", f"of {runs} runs: {', '.join(sorted(hashes))}")


def over_ros(runs):
    factors, traces, walls = [], set(), []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(runs):
            start = time.perf_counter()
            subprocess.run(["rosrun", "aras_visual_servo_controller", "run", "experiment_1", "--output", folder],
                           check=True, capture_output=True)
            walls.append(time.perf_counter() - start)
        for path in pathlib.Path(folder).rglob("summary.json"):
            summary = json.loads(path.read_text())
            factors.append(summary["real_time_factor"])
            traces.add(summary["trace_sha256"][:16])
    row("over ROS, lockstep, bag recording, simulated / wall", f"{statistics.median(factors):.1f}",
        f"[{min(factors):.1f} .. {max(factors):.1f}] of {runs} runs")
    row("over ROS, distinct traces", f"{len(traces)}", f"of {runs} runs: {', '.join(sorted(traces))}")
    row("over ROS, wall seconds from start to report", f"{statistics.median(walls):.1f}")


def micro():
    for program, what in MICRO:
        path = WORKSPACE / program
        output = subprocess.run([path, "--benchmark_format=json", "--benchmark_min_time=0.3"], check=True,
                                capture_output=True, text=True).stdout
        for entry in json.loads(output)["benchmarks"]:
            row(f"{what}: {entry['name'].removeprefix('BM_')}", f"{entry['cpu_time']:.2f} {entry['time_unit']}",
                f"{1.0 / (entry['cpu_time'] * {'ns': 1e-9, 'us': 1e-6, 'ms': 1e-3}[entry['time_unit']]):,.0f} /s")


def laws():
    subprocess.run([sys.executable, WORKSPACE / "src/aras_visual_servo_controller/bench/law_times.py"], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=7, help="runs of each whole loop (default 7)")
    parser.add_argument("--no-ros", action="store_true", help="leave out the runs over ROS")
    parser.add_argument("--beside", metavar="COMMAND", help="another program to measure in turn with our loop")
    arguments = parser.parse_args()
    row("SHA-256 of 4 MiB", f"{calibration_ms():.2f} ms", "to compare machines by")
    accuracy(["experiment_1", "experiment_2", "experiment_1_paper", "experiment_2_paper", "experiment_1_binary",
              "experiment_2_binary"])
    in_process(arguments.runs, arguments.beside)
    micro()
    laws()
    if not arguments.no_ros:
        over_ros(max(3, arguments.runs // 2))


if __name__ == "__main__":
    main()
