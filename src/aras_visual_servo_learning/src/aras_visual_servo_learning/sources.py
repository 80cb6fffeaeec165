"""What can be exported: recorded runs, scenarios that are run here, and sweeps, as (name, record) one by one."""

from pathlib import Path
from typing import Iterable, Iterator, Tuple, Union

from aras_visual_servo import ParameterError, RunRecord, load_scenario
import aras_visual_servo as avs


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
    Raises:
        ParameterError: a sweep is asked for images.  BagError, StoreError: a source cannot be read.
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
            yield scenario.name, avs.run(scenario, **({"keep_images": True} if images else {}))


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
