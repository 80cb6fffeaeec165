"""What a worker of a sweep does: it gets some starts, runs them, and returns results. It keeps its simulators."""

import ctypes
import hashlib
import os
import threading
import time
from pathlib import Path
from typing import Any, Dict, List, Tuple

from aras_visual_servo import ParameterError, Scenario, resolve_uri, scenario_from_dict
from .plan import Start
from .run import SweepRunner


def make_setup(scenario: Scenario, drive_to_start: bool) -> Dict[str, Any]:
    """What a worker must know of a sweep, as a plain dict, with the hash of the files that it must have."""
    return {"scenario": scenario.as_dict(), "base": str(scenario._base or "."), "path": str(scenario.path or ""),
            "drive_to_start": bool(drive_to_start), "files": files_hash(scenario)}


def files_hash(scenario: Scenario) -> str:
    """SHA-256 of robot, controllers and models of a scenario, hexadecimal."""
    digest = hashlib.sha256(scenario.urdf_path.read_bytes() + scenario.controllers_path.read_bytes())
    for model in scenario.sim.get("scene", {}).get("models", []):
        if "file" in model:
            digest.update(resolve_uri(model["file"], scenario._base).read_bytes())
    return digest.hexdigest()


def scenario_of(setup: Dict[str, Any]) -> Scenario:
    """The scenario of a setup. Raises ParameterError if robot or targets on this machine are not those of the sweep."""
    path = Path(setup["path"]) if setup["path"] else None
    scenario = scenario_from_dict(setup["scenario"], source=setup["scenario"]["name"], base=Path(setup["base"]),
                                  path=path)
    if files_hash(scenario) != setup["files"]:
        raise ParameterError("robot, controllers or target files differ from those the sweep was started with: "
                             f"{scenario.urdf_path}, {scenario.controllers_path}")
    return scenario


def run_chunk(setup: Dict[str, Any], starts: List[Dict[str, Any]]) -> List[Tuple[Dict[str, Any], float]]:
    """Runs some starts, dicts of the fields of `Start`, as workers do. Returns a list of (row, wall_s).

    Raises: ParameterError: this machine has other files and cannot run the sweep.
    """
    bench = _bench(setup)
    results = []
    for start in starts:
        began_s = time.perf_counter()
        row, _ = bench.run(Start(**start))
        results.append((row, time.perf_counter() - began_s))
    return results


def plain(start: Start) -> Dict[str, Any]:
    """A Start as a plain dict, of the same values: `asdict` would copy each of them, half a second in ten thousand."""
    return dict(vars(start))


_kept = threading.local()  # a simulator may be used by one thread only


def _bench(setup):
    if getattr(_kept, "setup", None) != setup:
        _keep_memory()
        _kept.bench, _kept.setup = SweepRunner(scenario_of(setup), setup["drive_to_start"], images=False), setup
    return _kept.bench


def _keep_memory():
    """Let glibc keep freed memory for the next image.

    Dask makes its workers return all freed memory to the system at once, which costs 10 000 page faults and two thirds
    more time in every run. -1 is M_TRIM_THRESHOLD, -3 is M_MMAP_THRESHOLD (malloc.h), which may be 32 MiB at most.
    """
    if "MALLOC_TRIM_THRESHOLD_" in os.environ:
        mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
        if mallopt is not None:
            mallopt(-1, 256 * 2 ** 20)
            mallopt(-3, 32 * 2 ** 20)
