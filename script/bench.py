"""The figures of docs/performance.md: accuracy, determinism, speed. Prints one table; run it through script/bench."""
import argparse
import hashlib
import json
import pathlib
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

WORKSPACE = pathlib.Path(__file__).resolve().parents[1]
SIM_BENCH = WORKSPACE / "src/aras_visual_servo_sim/bench"
STOP_RULE = WORKSPACE / "src/aras_visual_servo_study/bench/stop_rule.py"


def python_bench(program, *arguments):
    return [sys.executable, SIM_BENCH / program, *arguments]


# What other programs can be measured beside, our program that measures it, and whether more is better.
IN_TURN = {
    "physics": ("physics of the arm, Python, steps / s", python_bench("rates.py", "physics"), True),
    "camera": ("camera, flat scene fills the view, Python, frames / s", python_bench("rates.py", "camera", "plane"),
               True),
    "lit": ("camera, a shaded solid fills the view, frames / s", python_bench("rates.py", "camera", "lit"), True),
    "picture": ("camera, a picture fills the view, frames / s", python_bench("rates.py", "camera", "picture"), True),
    "boxes": ("camera, ten boxes on a flat scene, frames / s", python_bench("rates.py", "camera", "boxes"), True),
    "start": ("process start to first image, Python [s]", python_bench("start_up.py"), False),
    "start_solid": ("the same, a solid in view [s]", python_bench("start_up.py", "--solid"), False),
    "start_opengl": ("the same, by OpenGL [s]", python_bench("start_up.py", "--opengl"), False),
}
# google-benchmark executables, and the rows of theirs that stand in the table: (program, row, what it is)
MICRO = (
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
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import fit_decay

    for name in names:
        record = avs.run(avs.load_scenario(name))
        result = avs.judge(record)
        error = result.final_error
        row(f"{name}: |x|, |y|, |z| [mm], angle [deg]",
            "%.3f %.3f %.3f %.4f" % (abs(error["x_mm"]), abs(error["y_mm"]), abs(error["z_mm"]), error["angle_deg"]),
            f"{'converged' if result.converged else 'NOT CONVERGED'} in {result.duration_s:.2f} s simulated")
        if result.gains_per_s:
            shares = [abs(rate / result.gains_per_s[key] - 1.0) for key, rate in fit_decay(record).items()
                      if rate == rate]
            row(f"{name}: decay against lambda, largest deviation", f"{100 * max(shares):.1f} %")


def loop_factor():
    import aras_visual_servo as avs

    record = avs.ServoLoop(avs.load_scenario("experiment_1")).run()
    return record.real_time_factor, record.run_hash


def last_number(command):
    """What a program measured: the last word it prints."""
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[-1])


def compare(what, ours, others, runs, more_is_better=True):
    """Measures ours() and the other programs in turn, so that a machine that slows down slows all of them."""
    values, theirs = [], {command: [] for command in others}
    for _ in range(runs):
        values.append(ours())
        for command, found in theirs.items():
            found.append(last_number(shlex.split(command)))
    row(what, f"{statistics.median(values):,.2f}", f"[{min(values):,.2f} .. {max(values):,.2f}] of {runs} runs")
    for command, found in theirs.items():
        ratios = [a / b if more_is_better else b / a for a, b in zip(values, found)]
        row(f"  {command[-50:]}", f"{statistics.median(found):,.2f}", f"[{min(found):,.2f} .. {max(found):,.2f}], "
            f"ours is {statistics.median(ratios):.2f} times as good, run by run")


def in_process(runs, others):
    hashes = set()

    def ours():
        factor, run_hash = loop_factor()
        hashes.add(run_hash)
        return factor

    compare("whole loop in process, simulated / wall seconds, one core", ours, others, runs)
    row("in process, distinct run hashes", f"{len(hashes)}", f"of {runs} runs: {', '.join(sorted(hashes))}")


def simulator(runs, beside):
    for name, (what, command, more_is_better) in IN_TURN.items():
        compare(what, lambda command=command: last_number(command), beside[name], runs, more_is_better)
    for arguments in ([], ["--solid"], ["--opengl"], ["--blind"]):
        output = subprocess.run([sys.executable, SIM_BENCH / "start_up.py", *arguments], check=True,
                                capture_output=True, text=True).stdout
        row(f"resident memory after the first image {' '.join(arguments)}", " ".join(output.split()[1:3]).rstrip(","))


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
    bare = [unrecorded_factor() for _ in range(runs)]
    row("over ROS, lockstep, nothing recorded, simulated / wall", f"{statistics.median(bare):.1f}",
        f"[{min(bare):.1f} .. {max(bare):.1f}] of {runs} runs")
    row("over ROS, distinct traces", f"{len(traces)}", f"of {runs} runs: {', '.join(sorted(traces))}")
    row("over ROS, wall seconds from start to report", f"{statistics.median(walls):.1f}")


def unrecorded_factor():
    """Simulated over wall seconds of a run over ROS that records nothing; the node says it."""
    said = subprocess.run(["roslaunch", "aras_visual_servo_controller", "servo.launch", "scenario:=experiment_1",
                           "record:=false"], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return float(re.search(r"real-time factor ([0-9.]+)", said.stdout)[1])


def micro():
    for program, what in MICRO:
        path = WORKSPACE / program
        output = subprocess.run([path, "--benchmark_format=json", "--benchmark_min_time=0.3"], check=True,
                                capture_output=True, text=True).stdout
        for entry in json.loads(output)["benchmarks"]:
            if "error_message" in entry:
                raise SystemExit(f"{path.name}: {entry['name']} did not run: {entry['error_message']}")
            row(f"{what}: {entry['name'].removeprefix('BM_')}", f"{entry['cpu_time']:.2f} {entry['time_unit']}",
                f"{1.0 / (entry['cpu_time'] * {'ns': 1e-9, 'us': 1e-6, 'ms': 1e-3}[entry['time_unit']]):,.0f} /s")


def laws():
    subprocess.run([sys.executable, WORKSPACE / "src/aras_visual_servo_study/bench/law_times.py"], check=True)


def read_beside(entries):
    """WHAT=COMMAND entries as lists of commands by what they measure."""
    beside = {name: [] for name in ("loop", *IN_TURN)}
    for entry in entries:
        name, _, command = entry.partition("=")
        if name not in beside or not command.strip():
            raise SystemExit(f"--beside: found '{entry}', allowed WHAT=COMMAND with WHAT one of {', '.join(beside)}")
        beside[name].append(command)
    return beside


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=7, help="runs of each measurement in turn (default 7)")
    parser.add_argument("--no-ros", action="store_true", help="leave out the runs over ROS")
    parser.add_argument("--beside", metavar="WHAT=COMMAND", action="append", default=[],
                        help=f"another program to measure in turn with ours; WHAT: loop, {', '.join(IN_TURN)}")
    parser.add_argument("--in-turn-only", action="store_true", help="only what --beside can stand beside")
    parser.add_argument("--paper", action="store_true", help="only the table beside the paper's figures")
    parser.add_argument("--stop-rule", type=int, metavar="RUNS",
                        help="only whether CONVERGED means arrived (docs/sweeps.md)")
    arguments = parser.parse_args()
    if arguments.stop_rule:
        return subprocess.run([sys.executable, STOP_RULE, "--runs", str(arguments.stop_rule)]).returncode
    if arguments.paper:
        sys.path.insert(0, str(WORKSPACE / "script/pictures"))
        import paper_table
        return paper_table.main()
    beside = read_beside(arguments.beside)
    row("SHA-256 of 4 MiB", f"{calibration_ms():.2f} ms", "to compare machines by")
    in_process(arguments.runs, beside["loop"])
    simulator(arguments.runs, beside)
    if arguments.in_turn_only:
        return
    accuracy(["experiment_1", "experiment_2", "experiment_1_paper", "experiment_2_paper", "experiment_1_binary",
              "experiment_2_binary"])
    micro()
    laws()
    if not arguments.no_ros:
        over_ros(max(3, arguments.runs // 2))


if __name__ == "__main__":
    sys.exit(main())
