"""Whether one graph stays as it was through long use: `script/endurance soak MINUTES`.

Two cameras, a subscriber that is too slow for their images, goals, resets, and models that come and go. It fails when
a process grows, a message that was published is not in the bag, a node gives the same warning twice, or a goal has
another hash than the first.
"""
import collections
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from pathlib import Path

import user as user_module
from disturber import MARK, marked
from ros_graph import Graph

from aras_visual_servo.scenario.scenario import load_scenario

HERE = Path(__file__).resolve().parent
SCENARIO = HERE / "soak.yaml"
NAMESPACE = "/aras_visual_servo"
WARM_UP_PART = 0.2      # of the time, for caches and pools to fill
WINDOW_PART = 0.1       # of the time, whose median is the memory at the start or the end
LOOKS = 200             # at the memory, evenly in time
MOST_GROWTH_MIB = 5.0
SLOW_S = 1.0            # that the slow subscriber takes over an image: the queues to it fill up within the warm-up
START_LIMIT_S = 300.0


class Memory:
    """The memory that belongs to each process alone, sampled over time. Attributes: samples: {name: [(s, MiB)]}."""

    def __init__(self, mark):
        self._mark, self.samples = mark, collections.defaultdict(list)

    def look(self, now_s):
        """Take a sample of every process."""
        for process in marked(self._mark):
            found = _anonymous_mib(process)
            if found is not None:
                self.samples[f"{_name(process)} {process}"].append((now_s, found))

    def growth(self, duration_s):
        """Rows (name, MiB after the warm-up, MiB at the end) of the processes that ran all the time."""
        rows = []
        for name, samples in sorted(self.samples.items()):
            windows = [[mib for now_s, mib in samples if begin <= now_s / duration_s <= begin + WINDOW_PART]
                       for begin in (WARM_UP_PART, 1.0 - WINDOW_PART)]
            if all(windows):
                rows.append((name, *map(statistics.median, windows)))
        return rows


def _anonymous_mib(process):
    try:
        found = re.search(r"RssAnon:\s+(\d+) kB", Path(f"/proc/{process}/status").read_text())
    except OSError:
        return None
    return int(found[1]) / 1024 if found else None


def _name(process):
    try:
        words = Path(f"/proc/{process}/cmdline").read_bytes().split(b"\0")
    except OSError:
        return "?"
    names = [Path(word.decode(errors="replace")).name for word in words[:2] if word]
    return names[-1] if names and names[0].startswith("python") else (names or ["?"])[0]


class Uses:
    """What the user said. Attributes: hashes, warnings: Counters.  lost: texts.  published, recorded: numbers."""

    def __init__(self):
        self.hashes, self.warnings, self.lost = collections.Counter(), collections.Counter(), []
        self.published = self.recorded = 0
        self.ready, self.ended = threading.Event(), False

    def read(self, stream):
        """Take all lines."""
        for line in stream:
            kind, _, rest = line.strip().partition(" ")
            if kind == "goal":
                run_hash, trace, published, recorded = rest.split()
                self.hashes[run_hash, trace] += 1
                self.published += int(published)
                self.recorded += int(recorded)
            elif kind == "lost":
                self.lost.append(rest)
            elif kind == "said":
                self.warnings[re.sub(r"[0-9.]+", "N", rest)] += 1
            self.ended = self.ended or kind == "end"
            if kind == "ready":
                self.ready.set()
        self.ready.set()


def soak(minutes, seed, uses_of=()):
    """Use one graph; uses_of: names of uses, () for all. Returns (text, whether all is well)."""
    mark, uses = uuid.uuid4().hex, Uses()
    memory = Memory(mark)
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
            graph.start(sys.executable, str(HERE / "slow_subscriber.py"), str(SLOW_S),
                        *(f"{NAMESPACE}/{camera}/image_raw" for camera in ("camera", "observer")))
            with open(folder / "user.txt", "wb") as said:
                process = subprocess.Popen([sys.executable, user_module.__file__, str(minutes), str(seed), str(folder),
                                            *uses_of],
                                           env=dict(graph.environment, ROS_NAMESPACE=NAMESPACE), stdout=subprocess.PIPE,
                                           stderr=said, text=True)
            try:
                duration_s = _watch(process, uses, memory, 60.0 * minutes)
            finally:
                process.kill()
                process.wait()
            said = (folder / "user.txt").read_text(errors="replace")
            fault = "" if uses.ended else said[-3000:] + graph.log()[-3000:]
    return report(uses, memory.growth(duration_s), fault)


def _watch(process, uses, memory, duration_s):
    reader = threading.Thread(target=uses.read, args=(process.stdout,), daemon=True)
    reader.start()
    uses.ready.wait(START_LIMIT_S)
    begin_s = time.monotonic()
    while reader.is_alive():
        memory.look(time.monotonic() - begin_s)
        reader.join(max(0.2, duration_s / LOOKS))
    return time.monotonic() - begin_s


def report(uses, growth, fault):
    """(text, whether all is well) of what was found."""
    repeated = {text: count for text, count in uses.warnings.items() if count > 1}
    grown = [name for name, before, after in growth if after - before > MOST_GROWTH_MIB]
    lines = [f"goals: {sum(uses.hashes.values())}, different hashes: {len(uses.hashes)}",
             f"messages of all recorded topics, images among them: {uses.published} published, {uses.recorded} in bags"]
    lines += [f"  lost: {text}" for text in uses.lost]
    lines += ["memory of each process after the warm-up and at the end [MiB]:"]
    lines += [f"  {name:40} {before:8.1f} {after:8.1f} {after - before:+7.1f}" for name, before, after in growth]
    lines += [f"warnings: {len(uses.warnings)} kinds, {len(repeated)} of them repeated"]
    lines += [f"  {count} x {text}" for text, count in sorted(repeated.items())]
    lines += [f"broke off:\n{fault}"] if fault else []
    well = len(uses.hashes) == 1 and not (uses.lost or repeated or grown or fault) and bool(growth) \
        and uses.published == uses.recorded
    return "\n".join([*lines, "nothing found" if well else "NOT well: " + ", ".join(filter(None, (
        "hashes" * (len(uses.hashes) != 1), "lost messages" * bool(uses.lost or uses.published != uses.recorded),
        "repeated warnings" * bool(repeated), "memory of " + ", ".join(grown) if grown else "",
        "no memory seen" * (not growth), "broke off" * bool(fault))))]), well


def add_arguments(parser):
    """Arguments of `soak`."""
    parser.add_argument("minutes", type=float, help="wall time for which the graph is used")
    parser.add_argument("--seed", type=int, default=0, help="of the order of uses (default: 0)")
    parser.add_argument("--only", nargs="+", default=(), choices=user_module.USES, help="these uses (default: all)")


def main(arguments):
    """Work. Returns 0 if all is well, else 1."""
    text, well = soak(arguments.minutes, arguments.seed, arguments.only)
    print(text)
    return 0 if well else 1
