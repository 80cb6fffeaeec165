"""The command `export`. Exit codes: 0 done, 2 bad input, 3 could not run."""

import os
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Iterable, Iterator, List, Optional, Tuple, Union

import aras_visual_servo as avs
from aras_visual_servo import ParameterError, RunRecord, cli, load_scenario


def export_main(argv: Optional[List[str]] = None) -> int:
    """`export SOURCE ... --to FILE` writes runs as a data set. Returns the exit code."""
    return cli.run_verb("rosrun aras_visual_servo_learning export", EXPORT, argv)


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("sources", nargs="+", metavar="SOURCE", help="bag or folder of bags, folder of a sweep (its "
                        "runs are repeated), or scenario by name or path, which is run here")
    parser.add_argument("--to", required=True, metavar="FILE", help="file to write: NAME.hdf5 or NAME.mcap")
    parser.add_argument("--images", action="store_true", help="HDF5 only: with the images of the servo phase")
    parser.add_argument("--converged", action="store_true", help="HDF5 only: leave out runs that did not converge")


def _work(arguments: Namespace) -> int:
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
    return cli.EXIT_PASSED


EXPORT = cli.Command(
    "Write runs and sweeps as HDF5 in robomimic's layout, or as MCAP.",
    [("experiment_1 --to runs.hdf5 --images", "a scenario, run here, with its images, as robomimic reads it"),
     ("results/sweeps/experiment_1/STAMP --to sweep.hdf5", "every run of a sweep"),
     ("results/experiment_1/STAMP/run.bag --to run.mcap", "every message of a bag")], _options, _work)


def _hdf5(arguments: Namespace, path: Path) -> str:
    from .robomimic import write_hdf5
    count = write_hdf5(path, records(arguments.sources, arguments.images), arguments.images, arguments.converged)
    return f"{count} demonstrations"


def _mcap(arguments: Namespace, path: Path) -> str:
    from .mcap_file import McapFile
    with McapFile(path) as file:
        for source in arguments.sources:
            if is_bag(source):
                file.add_bags(source)
            else:
                for name, record in records([source]):
                    file.add_record(name, record)
    return f"{file.messages} messages"


def is_bag(source: Union[str, Path]) -> bool:
    """Whether this names a bag or a folder with bags."""
    path = Path(source)
    return path.suffix == ".bag" or path.is_dir() and any(path.glob("*.bag"))


def is_sweep(source: Union[str, Path]) -> bool:
    """Whether this is the folder of a sweep."""
    from aras_visual_servo_study.sweep.store import FILE
    return (Path(source) / FILE).is_file()


def records(sources: Iterable[Union[str, Path]], images: bool = False) -> Iterator[Tuple[str, RunRecord]]:
    """Yield (name, RunRecord) of every source.

    Args:
        sources: bags or folders of bags; folders of sweeps, whose runs are repeated, each with its own start, noise and
            perturbations; names of scenarios or paths of their files, which are run here.
        images: with the images of the servo phase, which a sweep's runs do not keep.
    Raises: ParameterError: a sweep is asked for images.  BagError, StoreError: a source cannot be read.
    """
    for source in map(str, sources):
        if is_sweep(source):
            if images:
                raise ParameterError(f"--images: found the sweep '{source}', allowed are runs: a sweep keeps no images")
            yield from _of_sweep(source)
        elif is_bag(source):
            from aras_visual_servo_controller import read_bag  # needs rosbag
            yield Path(source).stem, read_bag(source, keep_images=images)
        else:
            scenario = load_scenario(source)
            yield scenario.name, avs.run(scenario, keep_images=images)


def _of_sweep(folder):
    from aras_visual_servo_study.sweep.run import SweepRunner
    from aras_visual_servo_study.sweep.store import SweepStore
    from aras_visual_servo_study.sweep.worker import scenario_of
    with SweepStore.open(folder) as store:
        starts, setup = store.starts(), store.meta["setup"]
    bench = SweepRunner(scenario_of(setup), setup["drive_to_start"])
    for start in starts:
        _, record = bench.run(start)
        if record is not None:  # None: the start was refused
            yield f"run_{start.id}", record
