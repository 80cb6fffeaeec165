"""The command `benchmark`. Exit codes: 0 done, 2 bad input, 3 could not run, 130 interrupted."""

import os
import re
import shlex
import sys
from pathlib import Path

from aras_visual_servo.cli.parser import command_parser, parse
from aras_visual_servo.cli.run import EXIT_PASSED, guarded
from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.processes import Interrupted

FOLDER = "benchmarks"
#: What of a user's own may take the place of ours.
OWN = "board", "meshes"
EXAMPLES = (("vit_vs --starts 60", "60 of the 500 starts of each case, spread evenly"),
            ("vit_vs --cases orb_plain --name mine", "one case; the same line again goes on where it was interrupted"),
            ("vit_vs --board poster.png", "with a picture of your own on the board"),
            ("cns_render --meshes ycb", "with the meshes of a folder of yours, which are dropped on the table first"),
            ("latency --starts 1000", "a map of success over two delays, from the first 1000 of its 10 000 runs"),
            ("map --starts 54", "every law with every set of features: one page of maps over distance and rotation"),
            ("canonical", "the laws on the canonical tasks, on the free camera and on the arm"))


def benchmark_main(argv=None):
    """`benchmark vit_vs` runs a published protocol and prints its table. Returns the exit code."""
    parser = command_parser("benchmark", "Run a published protocol, and write a table of success rates with "
                            "confidence intervals beside the published ones (benchmark.md, benchmark.csv).", EXAMPLES)
    parser.add_argument("protocol", nargs="?", help="name of the protocol; without, the known ones are listed")
    parser.add_argument("--starts", type=int, metavar="N",
                        help="starts of each case, spread evenly over those of the protocol (default: all)")
    parser.add_argument("--cases", type=_names, default=(), metavar="A,B,...", help="cases to run (default: all)")
    parser.add_argument("--board", metavar="FILE", help="picture to put on the board in place of our own")
    parser.add_argument("--meshes", metavar="FOLDER", help="meshes to drop in place of our own")
    parser.add_argument("--workers", type=int, metavar="N",
                        help="number of worker processes (default: one per core; 0: run in this process)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do the runs")
    parser.add_argument("--output", default="results", metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    parser.add_argument("--name", help="name of the folder DIR/benchmarks/PROTOCOL/NAME (default: the time); a "
                        "benchmark of this name that was interrupted is gone on with")
    arguments = parse(parser, argv)

    def work():
        from ..compare.protocols import known_protocols, protocol_named
        from aras_visual_servo.scenario.schema import NAME
        if arguments.protocol is None:
            for protocol in known_protocols():
                print(f"{protocol.name:<16}{protocol.title}")
            return EXIT_PASSED
        if arguments.workers is not None and arguments.workers < 0:
            raise ParameterError(f"--workers: found {arguments.workers}, allowed >= 0")
        if arguments.name is not None and not re.fullmatch(NAME, arguments.name):
            raise ParameterError(f"--name: found '{arguments.name}', allowed letters, digits, _ . -, not only dots")
        protocol = protocol_named(arguments.protocol)
        return _run(protocol, arguments)

    return guarded(work)


def _run(protocol, arguments):
    from ..compare.protocols.runner import as_markdown, run_case, save_table, table, total
    from ..report.report import create_result_folder
    from ..report.versions import installed_versions
    own = {name: getattr(arguments, name) for name in OWN if getattr(arguments, name) is not None}
    protocol.check_own(own)
    root = Path(os.path.expanduser(arguments.output)) / FOLDER
    folder = root / protocol.name / arguments.name if arguments.name else None
    if folder is None or not folder.is_dir():
        folder = create_result_folder(root, protocol.name, arguments.name)
    count = protocol.published_starts if arguments.starts is None else arguments.starts
    cases = protocol.cases(folder / "files", count, **own)
    unknown = [name for name in arguments.cases if name not in [case.name for case in cases]]
    if unknown:
        raise ParameterError(f"--cases: found {', '.join(unknown)}, allowed {', '.join(case.name for case in cases)}")
    command, versions = "rosrun aras_visual_servo_controller benchmark " + _words(arguments), installed_versions()
    results = []
    for case in cases:
        if arguments.cases and case.name not in arguments.cases:
            continue
        print(f"benchmark: {folder / case.name}", file=sys.stderr)
        try:
            rows = run_case(protocol, case, folder, command, versions, arguments.workers, arguments.scheduler)
        except Interrupted as interrupt:
            print(f"{interrupt}: go on with the same command and --name {folder.name}", file=sys.stderr)
            return interrupt.exit_code
        results.append((case, rows))
    lines = table(protocol, results)
    path = save_table(protocol, lines, folder)
    print(as_markdown(protocol, lines))
    print(f"{'hash':<20}{total(lines)[:16]}")
    print(f"{'table':<20}{path}")
    for picture in protocol.save_pictures(results, folder):
        print(f"{'page' if picture.suffix == '.html' else 'picture':<20}{picture}")
    return EXIT_PASSED


def _words(arguments):
    words = [arguments.protocol] + ([f"--starts {arguments.starts}"] if arguments.starts is not None else [])
    words += [f"--cases {','.join(arguments.cases)}"] if arguments.cases else []
    words += [f"--{name} {shlex.quote(getattr(arguments, name))}" for name in OWN if getattr(arguments, name)]
    return " ".join(words)


def _names(text):
    return tuple(name.strip() for name in text.split(",") if name.strip())
