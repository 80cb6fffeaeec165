"""The verb `benchmark`: published protocols."""

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from aras_visual_servo import cli
from aras_visual_servo.processes import Interrupted

FOLDER = "benchmarks"
#: What of a user's own may take the place of ours.
OWN = "board", "meshes"


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("protocol", nargs="?", help="name of the protocol; without, the known ones are listed")
    parser.add_argument("--starts", type=int, metavar="N",
                        help="starts of each case, spread evenly over those of the protocol (default: all)")
    parser.add_argument("--cases", type=cli.names, default=(), metavar="A,B,...",
                        help="cases to run, by their names or their beginnings, e.g. orb or orb_plain (default: all)")
    cli.add_changes(parser)
    parser.add_argument("--board", type=cli.file, metavar="FILE",
                        help="picture to put on the board in place of our own")
    parser.add_argument("--meshes", type=cli.file, metavar="FOLDER", help="meshes to drop in place of our own")
    cli.add_workers(parser)
    cli.add_output(parser, "benchmarks/PROTOCOL")


def _work(arguments: Namespace) -> int:
    from ..compare.protocols import known_protocols, protocol_named
    from ..compare.protocols.runner import as_markdown, run_protocol, save_table, table, total
    from ..report.report import create_result_folder
    if arguments.protocol is None:
        for protocol in known_protocols():
            print(f"{protocol.name:<16}{protocol.title}")
        return cli.EXIT_PASSED
    changes, protocol = cli.changes_of(arguments), protocol_named(arguments.protocol)
    own = {name: getattr(arguments, name) for name in OWN if getattr(arguments, name) is not None}
    protocol.check_own(own)
    root = Path(arguments.output) / FOLDER
    folder = root / protocol.name / arguments.name if arguments.name else None
    if folder is None or not folder.is_dir():
        folder = create_result_folder(root, protocol.name, arguments.name)
    try:
        results = run_protocol(protocol, folder, arguments.starts, arguments.cases, changes, own, arguments.repeat,
                               arguments.workers, arguments.scheduler)
    except Interrupted as interrupt:
        print(f"{interrupt}: continue with the same command and --name {folder.name}", file=sys.stderr)
        return interrupt.exit_code
    lines = table(protocol, results)
    path = save_table(protocol, lines, folder, arguments.repeat)
    print(as_markdown(protocol, lines, arguments.repeat))
    print(f"{'hash':<20}{total(lines)[:16]}")
    print(f"{'table':<20}{path}")
    for picture in protocol.save_pictures(results, folder):
        print(f"{'page' if picture.suffix == '.html' else 'picture':<20}{picture}")
    return cli.EXIT_PASSED


VERBS = {"benchmark": cli.Command(
    "Run a published protocol, and write a table of success rates with confidence intervals beside the published ones "
    "(benchmark.md, benchmark.csv). Repeat the command with its --name to continue an interrupted benchmark. "
    "--law replaces the law of every case, or selects the law where the protocol compares laws.",
    [("vit_vs --starts 60", "60 of the 500 starts of each case, spread evenly"),
     ("vit_vs --cases orb_plain --name mine", "one case; repeat the command to continue after an interruption"),
     ("vit_vs --board poster.png", "with a picture of your own on the board"),
     ("vit_vs --cases orb --law bounded --plugins my_servo", "with a law of your own"),
     ("cns_render --meshes ycb", "with the meshes of a folder of yours, which are dropped on the table first"),
     ("latency --starts 1000", "a map of success over two delays, from the first 1000 of its 10 000 runs"),
     ("map --starts 54", "every law with every set of features: one page of maps over distance and rotation"),
     ("canonical", "the laws on the canonical tasks, on the free camera and on the arm")], _options, _work)}
