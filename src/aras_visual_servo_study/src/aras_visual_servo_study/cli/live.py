"""The verb `live SCENARIO`: a run in this process, watched and changed from a page. Needs no master."""

import sys
import webbrowser
from argparse import ArgumentParser, Namespace
from asyncio import Future
from pathlib import Path

from aras_visual_servo import ParameterError, cli
from aras_visual_servo.processes import run_until_signal

PORT, FOXGLOVE_PORT = 8765, 8766


def _options(parser: ArgumentParser) -> None:
    cli.add_scenario(parser)
    parser.add_argument("--port", type=int, default=PORT, help=f"port of the page (default: {PORT}; 0: any free one)")
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS",
                        help="address to serve on; 127.0.0.1 (the default) is reached from this machine only")
    parser.add_argument("--speed", type=float, default=1.0, metavar="FACTOR",
                        help="simulated time per wall time (default: 1; 0: as fast as possible)")
    parser.add_argument("--idle", action="store_true",
                        help="wait for a button, instead of beginning with the first page")
    parser.add_argument("--lessons", type=Path, action="append", default=[], metavar="FOLDER",
                        help="folder with lessons of your own, one Python file each; may be given again")
    parser.add_argument("--foxglove", type=int, nargs="?", const=FOXGLOVE_PORT, metavar="PORT",
                        help=f"serve Foxglove too, on this port of this machine (default: {FOXGLOVE_PORT})")
    parser.add_argument("--edit", action="store_true",
                        help="an editor in the page for a law of your own; only for pages on this machine, because its "
                             "code runs in this process")
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def _work(arguments: Namespace) -> int:
    from ..live.lesson import load_lessons
    from ..live.messages import Start
    from ..live.run import LiveRun
    from ..live.runner import Runner
    from ..live.server import Server, is_loopback
    if not 0.0 <= arguments.speed <= 1000.0:
        raise ParameterError(f"--speed: found {arguments.speed:g}, allowed 0 to 1000")
    for folder in arguments.lessons:
        load_lessons(folder)
    run = LiveRun(cli.scenario_of(arguments), arguments.edit)
    runner = Runner(run, arguments.speed, None if arguments.idle else Start())

    async def work(came: "Future[None]") -> None:
        server = Server(runner, run.scenario.urdf_xml())
        address = server.listen(arguments.host, arguments.port)
        foxglove = "" if arguments.foxglove is None else server.serve_foxglove(arguments.foxglove)
        runner.start()
        print(f"live page of {run.scenario.name}: {address}", flush=True)
        if foxglove:
            print(f"foxglove: {foxglove}", flush=True)
        if not is_loopback(arguments.host):
            print("warning: anyone with this address can control the run; the connection is not encrypted",
                  file=sys.stderr)
        if arguments.open:
            webbrowser.open(address)
        try:
            await came
        finally:
            server.close()
            runner.close()

    run_until_signal(work)
    return cli.EXIT_PASSED


VERBS = {"live": cli.Command(
    "Run a scenario in this process and watch and change it on a page: 3-D view, camera image, curves, controls. "
    "Ctrl-C ends it.",
    [("experiment_1", "prints the address of the page"),
     ("mine.yaml --port 0 --open", "on any free port, in a browser"),
     ("experiment_1 --law ibvs --set servo.hold_s=1", "with another law and value"),
     ("experiment_1 --edit", "write a law in the page")], _options, _work)}
