#!/usr/bin/env python3
"""What the live page costs: its server with one viewer, what a viewer takes from a run, and the time to the first page.

    python3 live_page.py [SECONDS]       # each measurement takes so long [s], default 5; prints a line each

A viewer is a client of the page's socket that reads all and says so; a silent one is connected and reads nothing.
"""
import asyncio
import json
import pathlib
import statistics
import struct
import subprocess
import sys
import time

from tornado.websocket import websocket_connect

RUNS = 3


async def now(socket):
    """(head, whether there is an image) of the next message that says how the run stands."""
    while True:
        message = await socket.read_message()
        if isinstance(message, bytes):
            size, = struct.unpack_from("<I", message)
            head = json.loads(message[4:4 + size])
            if head["type"] == "now":
                return head, len(message) > 4 + size


async def view(address, seconds, silent):
    """(images, states) that came in the time."""
    socket = await websocket_connect(address.replace("http", "ws") + "socket")
    images = states = 0
    until = time.perf_counter() + seconds
    while time.perf_counter() < until:
        if silent:
            await asyncio.sleep(0.1)
            continue
        head, image = await now(socket)
        socket.write_message(str(head["number"]))
        states, images = states + 1, images + image
    socket.close()
    return images, states


def cpu_s(pid):
    """CPU seconds that the threads of a process have used."""
    threads = pathlib.Path(f"/proc/{pid}/task").glob("*/schedstat")
    return 1e-9 * sum(int(each.read_text().split()[0]) for each in threads)


class Page:
    """`live` in a process of its own."""

    def __init__(self, *words):
        self.started_s = time.perf_counter()
        command = ["rosrun", "aras_visual_servo_controller", "live", "experiment_1", "--port", "0", *words]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.address = next(line.split()[-1] for line in self.process.stdout if "http" in line)
        self.ready_s = time.perf_counter() - self.started_s

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


async def simulated_s(address):
    """Simulated time of the run that a page shows."""
    socket = await websocket_connect(address.replace("http", "ws") + "socket")
    head, _ = await now(socket)
    socket.close()
    return head["state"]["t"]


def share_of_a_core(seconds):
    """CPU share of the server with one viewer less that with none, at real time."""
    with Page("--speed", "1") as page:
        asyncio.run(view(page.address, 2.0, False))
        pid = page.process.pid
        before = cpu_s(pid)
        images, states = asyncio.run(view(page.address, seconds, False))
        watched = cpu_s(pid) - before
        time.sleep(1.5)
        before = cpu_s(pid)
        time.sleep(seconds)
        alone = cpu_s(pid) - before
    return (watched - alone) / seconds, watched / seconds, images / seconds, states / seconds


async def _speed(address, seconds, viewer):
    start, t0 = await simulated_s(address), time.perf_counter()
    if viewer is None:
        await asyncio.sleep(seconds)
    else:
        await view(address, seconds, viewer == "silent")
    end = await simulated_s(address)
    return (end - start) / (time.perf_counter() - t0)


def slow_down(seconds):
    """How much slower a run as fast as it can is with a viewer, and with a silent one: parts."""
    parts = {"viewer": [], "silent": []}
    with Page("--speed", "0") as page:
        asyncio.run(view(page.address, 1.0, False))
        for _ in range(RUNS):
            for kind in parts:
                alone = asyncio.run(_speed(page.address, seconds, None))
                watched = asyncio.run(_speed(page.address, seconds, kind))
                parts[kind].append(1.0 - watched / alone)
    return {kind: statistics.median(each) for kind, each in parts.items()}


def main():
    """Print everything."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    ready = []
    for _ in range(RUNS):
        with Page() as page:
            ready.append(page.ready_s)
    print(f"from the command to the page's address   {statistics.median(ready):.2f} s")
    more, watched, images, states = share_of_a_core(seconds)
    print(f"one viewer, {images:.0f} images and {states:.0f} states a second: {100 * more:.0f} % of a core more, "
          f"{100 * watched:.0f} % with the run")
    parts = slow_down(seconds)
    print(f"a run as fast as it can is slower by {100 * parts['viewer']:.1f} % with a viewer, "
          f"{100 * parts['silent']:.1f} % with one that reads nothing")


if __name__ == "__main__":
    main()
