#!/usr/bin/env python3
"""Memory of a session of the live page: python3 page_memory.py [--minutes 10] [--every 60], with the workspace sourced.

A headless Chromium looks at experiment_1 as a user does: servo, drag the time slider, go back to now, move the target,
change a gain, and again. A line each `--every` seconds: of the server its resident memory (RSS), the part that no
other process shares (PSS) and the part that is its own (anonymous); of the page the resident memory of its process,
the part of it that is its own, and the heap of JavaScript. All in MB (10^6 bytes).
"""
import argparse
import pathlib
import random
import subprocess
import sys
import tempfile
import time

PACKAGES = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(PACKAGES / "aras_visual_servo_study" / "test" / "support"))
from browser import Browser, end

PROGRAM = PACKAGES / "aras_visual_servo" / "scripts" / "aras-servo"
COLUMNS = ("t [s]", "rows", "runs", "server RSS", "PSS", "own", "page RSS", "own", "heap")
#: Between two things that the user does [s].
PAUSE_S = 1.0
TRACK = ("(() => { const e = document.querySelector('#time'); e.scrollIntoView({block: 'center'}); "
         "const b = e.getBoundingClientRect(); return [b.x, b.y + b.height / 2, b.width]; })()")


def memory(pid):
    """MB of a process: resident, proportional, anonymous."""
    fields = [line.split() for line in pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()[1:]]
    kilobytes = {name: int(size) for name, size, *_ in fields}
    return [kilobytes[name] * 1.024e-3 for name in ("Rss:", "Pss:", "Anonymous:")]


def renderers(browser):
    """Process ids of the pages of a browser: its own children, and theirs."""
    found, waiting = [], [browser._process.pid]
    while waiting:
        pid = waiting.pop()
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        waiting += map(int, children)
        if b"--type=renderer" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes():
            found.append(pid)
    return found


def line(browser, server, since_s):
    browser.call("Performance.enable")
    heap = {one["name"]: one["value"] for one in browser.call("Performance.getMetrics")["metrics"]}["JSHeapUsedSize"]
    rows, runs = browser.value("[aras.model.rows.length, aras.runs.all.length]")
    pages = max(map(memory, renderers(browser)))  # the others are spare
    numbers = [time.monotonic() - since_s, rows, runs, *memory(server), pages[0], pages[2], 1e-6 * heap]
    print("".join(f"{number:>12.0f}" for number in numbers), flush=True)


def scrub(browser, draws):
    x, y, width = browser.value(TRACK)
    ends = [(x + width * draws.uniform(0.02, 0.98), y) for _ in range(2)]
    browser.drag(*ends, steps=20)


def act(browser, draws):
    """One thing that a user does."""
    kind = draws.choice(("again", "scrub", "scrub", "live", "gain", "target"))
    if kind == "scrub":
        scrub(browser, draws)
    elif kind == "live":
        browser.click("#live-now")
    elif kind == "again":
        browser.click("#again")
    elif kind == "gain":
        values = {"servo.gains_per_s.xn": round(draws.uniform(1.0, 4.0), 2)}
        browser.value(f"aras.ask({{do: 'set', values: {values}}}).then(() => 1)")
    else:
        x, y = draws.uniform(-0.02, 0.08), draws.uniform(-0.05, 0.05)
        browser.value("(() => { const [, , z, ...q] = aras.model.state.target; return aras.ask({do: 'place_target', "
                      f"position_m: [{x}, {y}, z], q_xyzw: q}}).then(() => 1); }})()")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--every", type=float, default=60.0, metavar="SECONDS")
    parser.add_argument("--port", type=int, default=0)
    arguments = parser.parse_args()
    command = [sys.executable, str(PROGRAM), "live", "experiment_1", "--port", str(arguments.port)]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        with tempfile.TemporaryDirectory() as folder, Browser(folder, webgl=True) as browser:
            browser.open(server.stdout.readline().split()[-1])
            browser.wait("document.body.classList.contains('ready') && aras.model.state?.taught")
            print("".join(f"{name:>12}" for name in COLUMNS), flush=True)
            draws, since_s = random.Random(0), time.monotonic()
            line(browser, server.pid, since_s)
            told_s = since_s
            while time.monotonic() - since_s < 60.0 * arguments.minutes:
                act(browser, draws)
                time.sleep(PAUSE_S)
                if time.monotonic() - told_s >= arguments.every:
                    told_s += arguments.every
                    line(browser, server.pid, since_s)
            line(browser, server.pid, since_s)
            assert browser.said == [], browser.said
    finally:
        end(server)


if __name__ == "__main__":
    main()
