"""Whether a goal gives the same bytes whatever the machine does meanwhile: `script/endurance determinism`.

Each goal is run over ROS in lockstep: action, servo, recorded bag. Goals are given to graphs that are used again, and
one to each of many fresh graphs, while a disturber stops, nices and pins their processes and keeps cores busy. A goal
has two hashes: the simulator's, of joint trajectory and images, and that of the trace, which is made from the bag. They
are compared with those of a run in process.
"""
import collections
import concurrent.futures
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from pathlib import Path

import goals as goals_module
from disturber import MARK, Disturber
from ros_graph import Graph

import aras_visual_servo as avs
from aras_visual_servo.scenario.scenario import load_scenario

HERE = Path(__file__).resolve().parent
SCENARIO = HERE / "goal.yaml"
PER_GRAPH = 100       # goals that one graph is used for
GOAL_LIMIT_S = 300.0  # wall time within which a goal ends on a crowded machine
NAMESPACE = "/aras_visual_servo"


class Tally:
    """Counts goals by their hashes. Attributes: hashes: Counter of (run hash, trace hash).  faults: texts."""

    def __init__(self):
        self.hashes, self.faults, self.graphs = collections.Counter(), [], 0
        self.disturbances = collections.Counter()
        self._lock = threading.Lock()
        self._last_s = time.monotonic()

    def add(self, found, where):
        """Count the hashes of one goal."""
        with self._lock:
            new = found not in self.hashes
            self.hashes[found] += 1
            if new or time.monotonic() - self._last_s > 60.0:
                self._last_s = time.monotonic()
                print(f"{time.strftime('%H:%M:%S')} {sum(self.hashes.values())} goals, {self.graphs} graphs, hashes: "
                      f"{len(self.hashes)}" + (f"; new: {' '.join(found)} in {where}" if new else ""), flush=True)

    def fault(self, text):
        """Note a goal that gave no hash."""
        with self._lock:
            self.faults.append(text)
            print(f"{time.strftime('%H:%M:%S')} FAULT {text}", flush=True)

    def graph(self, disturbances):
        """Count a graph."""
        with self._lock:
            self.graphs += 1
            self.disturbances.update(disturbances)


def reference():
    """Hashes of the goal in process, without ROS."""
    return goals_module.hashes(avs.run(load_scenario(str(SCENARIO))))


def run_graph(count, seed, tally, ended, disturbed=True):
    """One graph with `count` goals, from its start to its end; it ends early once `ended` is set."""
    mark = uuid.uuid4().hex
    with tempfile.TemporaryDirectory(prefix="aras_endurance_") as folder:
        folder, scenario = Path(folder), Path(folder) / "resolved.yaml"
        scenario.write_text(load_scenario(str(SCENARIO)).as_yaml())
        with Graph(folder, **{MARK: mark}) as graph:
            graph.start("roscore", "-p", str(graph.port))
            graph.until(lambda: "/rosout" in graph.topics(), "a master")
            graph.start("roslaunch", "aras_visual_servo_controller", "servo.launch", f"scenario:={SCENARIO}",
                        "experiment:=false", "start_paused:=true", f"scenario_file:={scenario}",
                        f"results_dir:={folder}")
            graph.until(lambda: f"{NAMESPACE}/servo_state" in graph.topics(), "a controller")
            with open(folder / "goals.txt", "wb") as said, Disturber(mark, seed) if disturbed else Calm() as disturber:
                process = subprocess.Popen([sys.executable, goals_module.__file__, str(count), str(folder)],
                                           env=dict(graph.environment, ROS_NAMESPACE=NAMESPACE), stdout=subprocess.PIPE,
                                           stderr=said, text=True)
                try:
                    reached = _read(process, count, seed, tally, ended)
                finally:
                    process.kill()
                    process.wait()
            if reached < count and not ended.is_set():
                said = (folder / "goals.txt").read_text(errors="replace")
                tally.fault(f"seed {seed}: {reached} of {count} goals\n{said[-2000:]}\n{graph.log()[-2000:]}")
        tally.graph(disturber.counts)


def _read(process, count, seed, tally, ended):
    """Tell the tally what the node says. Returns how many goals it has worked through."""
    reached, watch = 0, _Watchdog(process)
    for line in process.stdout:
        kind, *words = line.split()
        if kind == "note":
            tally.fault(f"seed {seed}, goal {reached}: {' '.join(words)}")
        elif kind == "goal":
            watch.seen()
            reached += 1
            tally.add(tuple(words), f"goal {reached} of the graph of seed {seed}")
        if ended.is_set():
            break
    watch.end()
    return reached


class _Watchdog:
    """Ends a process from which nothing has come for GOAL_LIMIT_S."""

    def __init__(self, process):
        self._process, self._timer = process, None
        self.seen()

    def seen(self):
        """Something came."""
        self.end()
        self._timer = threading.Timer(GOAL_LIMIT_S, self._process.kill)
        self._timer.daemon = True
        self._timer.start()

    def end(self):
        """Nothing is waited for any more."""
        if self._timer is not None:
            self._timer.cancel()


class Calm:
    """In the place of a disturber: nothing is disturbed."""

    counts = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


def determinism(goals, graphs, seed, at_once=2, disturbed=True):
    """Run `goals` goals in graphs that are used again and one in each of `graphs` fresh graphs. Returns the `Tally`."""
    tally, ended = Tally(), threading.Event()
    sizes = [min(PER_GRAPH, goals - done) for done in range(0, goals, PER_GRAPH)]
    # Fresh graphs stand between those that are used again, so that a run that is broken off has had both.
    order = sorted([((k + 0.5) / len(sizes), size) for k, size in enumerate(sizes)]
                   + [((k + 0.5) / graphs, 1) for k in range(graphs)])
    try:
        with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
            jobs = [pool.submit(_guarded, size, seed + k, tally, ended, disturbed) for k, (_, size) in enumerate(order)]
            try:
                concurrent.futures.wait(jobs)
            except KeyboardInterrupt:
                ended.set()
                for job in jobs:
                    job.cancel()
    except KeyboardInterrupt:
        ended.set()
    return tally


def _guarded(count, seed, tally, ended, disturbed):
    if ended.is_set():
        return
    try:
        run_graph(count, seed, tally, ended, disturbed)
    except Exception as error:  # a graph that does not start is one of the faults that are counted
        tally.fault(f"seed {seed}: {type(error).__name__}: {error}")


def report(tally, expected, goals, graphs):
    """Text of the outcome, and whether there is one hash, that of the run in process, and no fault."""
    reached = sum(tally.hashes.values())
    lines = [f"determinism: {reached} goals of {goals + graphs} asked for, in {tally.graphs} graphs",
             "disturbances: " + (", ".join(f"{count} x {what}" for what, count in sorted(tally.disturbances.items()))
                                 or "none"),
             f"in process:   {' '.join(expected)}"]
    lines += [f"{count:6d} goals: {' '.join(found)}" for found, count in tally.hashes.most_common()]
    lines += [f"faults: {len(tally.faults)}", f"different hashes: {len(set(tally.hashes) | {expected}) - 1}"]
    return "\n".join(lines), set(tally.hashes) == {expected} and not tally.faults


def add_arguments(parser):
    """Arguments of `determinism`."""
    parser.add_argument("--goals", type=int, default=100, help="goals in graphs that are used again (default: 100)")
    parser.add_argument("--graphs", type=int, default=10, help="fresh graphs of one goal each (default: 10)")
    parser.add_argument("--seed", type=int, default=0, help="of what is disturbed, and how (default: 0)")
    parser.add_argument("--at-once", type=int, default=2, help="graphs that run side by side (default: 2)")
    parser.add_argument("--calm", action="store_true", help="disturb nothing")


def main(arguments):
    """Work. Returns 0 if all goals gave the one hash, else 1."""
    expected = reference()
    tally = determinism(arguments.goals, arguments.graphs, arguments.seed, arguments.at_once, not arguments.calm)
    text, same = report(tally, expected, arguments.goals, arguments.graphs)
    print(text)
    return 0 if same else 1
