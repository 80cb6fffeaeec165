"""The command `live SCENARIO`: a run in this process, watched and changed from a page. Needs no master."""

import argparse
import sys
import webbrowser

from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.processes import run_until_signal
from aras_visual_servo.cli.run import EXIT_PASSED, guarded, parse_overrides

PORT = 8765


def live_main(argv=None):
    """Serve the page until a signal comes. Returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="live", description="Run a scenario in this process and watch and change it on a page: 3-D view, camera "
                                 "image, curves, controls. Ctrl-C ends it.",
        epilog="live experiment_1        live my.yaml --port 0 --open        live experiment_1 --set servo.hold_s=1")
    parser.add_argument("scenario", help="name of a scenario of this package, or path of a YAML file")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="replace a value of the scenario; may be given several times")
    parser.add_argument("--port", type=int, default=PORT, help=f"port of the page (default: {PORT}; 0: any free one)")
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS",
                        help="address to serve on; 127.0.0.1 (the default) is reached from this machine only")
    parser.add_argument("--speed", type=float, default=1.0, metavar="FACTOR",
                        help="simulated time per wall time (default: 1; 0: as fast as possible)")
    parser.add_argument("--idle", action="store_true",
                        help="wait for a button, instead of beginning with the first page")
    parser.add_argument("--open", action="store_true", help="open the page in the browser")
    arguments = parser.parse_args(argv)
    return guarded(lambda: _serve(arguments))


def _serve(arguments):
    from ..live.messages import Start
    from ..live.run import LiveRun
    from ..live.runner import Runner
    from ..live.server import Server, is_loopback
    from aras_visual_servo.scenario.scenario import load_scenario
    if not 0.0 <= arguments.speed <= 1000.0:
        raise ParameterError(f"--speed: found {arguments.speed:g}, allowed 0 to 1000")
    run = LiveRun(load_scenario(arguments.scenario, parse_overrides(arguments.overrides)))
    runner = Runner(run, arguments.speed, None if arguments.idle else Start())

    async def work(came):
        server = Server(runner, run.scenario.urdf_xml())
        address = server.listen(arguments.host, arguments.port)
        runner.start()
        print(f"live page of {run.scenario.name}: {address}", flush=True)
        if not is_loopback(arguments.host):
            print("others on the network who know this address can drive the run; the page is sent unencrypted",
                  file=sys.stderr)
        if arguments.open:
            webbrowser.open(address)
        try:
            await came
        finally:
            server.close()
            runner.close()

    run_until_signal(work)
    return EXIT_PASSED
