"""The command `export`. Exit codes: 0 done, 2 bad input, 3 could not run."""

import os
from pathlib import Path

from aras_visual_servo.cli.parser import command_parser, parse
from aras_visual_servo.cli.run import EXIT_PASSED, guarded
from aras_visual_servo import ParameterError

EXAMPLES = (("experiment_1 --to runs.hdf5 --images", "a scenario, run here, with its images, as robomimic reads it"),
            ("results/sweeps/experiment_1/STAMP --to sweep.hdf5", "every run of a sweep"),
            ("results/experiment_1/STAMP/run.bag --to run.mcap", "every message of a bag"))


def export_main(argv=None):
    """`export SOURCE ... --to FILE` writes runs as a data set. Returns the exit code."""
    parser = command_parser("export", "Write runs and sweeps as HDF5 in robomimic's layout, or as MCAP.", EXAMPLES,
                            package="aras_visual_servo_learning")
    parser.add_argument("sources", nargs="+", metavar="SOURCE", help="bag or folder of bags, folder of a sweep (its "
                        "runs are repeated), or scenario by name or path, which is run here")
    parser.add_argument("--to", required=True, metavar="FILE", help="file to write: NAME.hdf5 or NAME.mcap")
    parser.add_argument("--images", action="store_true", help="HDF5 only: with the images of the servo phase")
    parser.add_argument("--converged", action="store_true", help="HDF5 only: leave out runs that did not converge")
    arguments = parse(parser, argv)

    def work():
        target = Path(os.path.expanduser(arguments.to))
        kind = target.suffix
        if kind not in (".hdf5", ".mcap"):
            raise ParameterError(f"--to: found '{target}', allowed NAME.hdf5 | NAME.mcap")
        if kind == ".mcap" and (arguments.images or arguments.converged):
            raise ParameterError("--images, --converged: found .mcap, allowed with .hdf5 only")
        part = target.with_name(target.name + ".part")  # a file of this name is a whole one
        try:
            said = _hdf5(arguments, part) if kind == ".hdf5" else _mcap(arguments, part)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)
        print(f"{target}: {said}")
        return EXIT_PASSED

    return guarded(work)


def _hdf5(arguments, path):
    from .robomimic import write_hdf5
    from .sources import records
    count = write_hdf5(path, records(arguments.sources, arguments.images), arguments.images, arguments.converged)
    return f"{count} demonstrations"


def _mcap(arguments, path):
    from .mcap_file import McapFile
    from .sources import is_bag, records
    with McapFile(path) as file:
        for source in arguments.sources:
            if is_bag(source):
                file.add_bags(source)
            else:
                for name, record in records([source]):
                    file.add_record(name, record)
    return f"{file.messages} messages"
