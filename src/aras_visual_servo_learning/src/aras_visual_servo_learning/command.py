"""The command `export`. Exit codes: 0 done, 2 bad input, 3 could not run."""

import os
import shutil
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
    parser.add_argument("--to", required=True, metavar="FILE", help="file to write: NAME.hdf5 or NAME.mcap, or folder "
                        "of a ROS 2 bag: NAME.rosbag2")
    parser.add_argument("--images", action="store_true", help="HDF5 only: with the images of the servo phase")
    parser.add_argument("--converged", action="store_true", help="HDF5 only: leave out runs that did not converge")


def _work(arguments: Namespace) -> int:
    target = Path(os.path.expanduser(arguments.to))
    kind = target.suffix
    if kind not in WRITERS:
        raise ParameterError(f"--to: found '{target}', allowed {' | '.join('NAME' + kind for kind in WRITERS)}")
    if kind != ".hdf5" and (arguments.images or arguments.converged):
        raise ParameterError(f"--images, --converged: found {kind}, allowed with .hdf5 only")
    if kind == ".rosbag2" and target.exists():
        raise ParameterError(f"--to: {target} is there already; choose another name")
    folder = target.with_name(target.name + ".part")  # a file or folder named `target` is a whole one
    folder.mkdir(exist_ok=True)
    try:
        said = WRITERS[kind](arguments, folder / target.name)
        os.replace(folder / target.name, target)
    finally:
        shutil.rmtree(folder)
    print(f"{target}: {said}")
    return cli.EXIT_PASSED


EXPORT = cli.Command(
    "Write runs and sweeps as HDF5 in robomimic's layout, as MCAP, or as a bag of ROS 2.",
    [("experiment_1 --to runs.hdf5 --images", "a scenario, run here, with its images, as robomimic reads it"),
     ("results/sweeps/experiment_1/STAMP --to sweep.hdf5", "every run of a sweep"),
     ("results/experiment_1/STAMP/run.bag --to run.mcap", "every message of a bag"),
     ("results/experiment_1/STAMP/run.bag --to run.rosbag2", "the same with ROS 2 types, for ROS 2's tools")],
    _options, _work)


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


def _rosbag2(arguments: Namespace, path: Path) -> str:
    from .rosbag2_folder import write_rosbag2
    faults = [f"SOURCE: found '{source}', allowed with .rosbag2 are bags and folders of bags"
              for source in arguments.sources if not is_bag(source)]
    if faults:
        raise ParameterError(faults)
    return f"{write_rosbag2(path, arguments.sources)} messages"


WRITERS = {".hdf5": _hdf5, ".mcap": _mcap, ".rosbag2": _rosbag2}


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
