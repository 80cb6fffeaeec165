"""Sweeps, their comparison and published protocols in a line or two: `avs.sweep`, `avs.compare`, `avs.benchmark`.

    ours = avs.sweep("experiment_1", starts=50)
    theirs = avs.sweep("experiment_1", starts=50, law="mine", plugins=["my_servo"])
    print(ours.success, avs.compare(ours, theirs))
"""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from aras_visual_servo import ParameterError, Scenario, ServoLoop, load_plugins, load_scenario, processes
from .compare.protocols import Protocol, protocol_named
from .compare.protocols.runner import Results, as_markdown, run_protocol, save_table, table
from .compare.sweeps import LETTERS, format_comparison, gate_fires, numbers_of, save_sweeps_page
from .report.versions import installed_versions
from .sweep.engine import Progress, open_sweep, run_pending
from .sweep.figure import make_figure
from .sweep.map import joint_units
from .sweep.plan import Start, SweepSettings, make_starts
from .sweep.report import format_rows, save_report
from .sweep.statistics import aggregate
from .sweep.store import SweepStore
from .sweep.worker import scenario_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Rate(NamedTuple):
    """A rate of success in [0, 1] with Wilson's 95 % interval; NaN if no start could be run."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class SweepResult:
    """A sweep that was run.

    Attributes:
        scenario: of all runs.  starts: in the order of their ids.
        rows: one dict per run: outcome, reason, success, duration_s, error_mm, angle_deg, ... (docs/sweeps.md).
        meta: what `SweepStore.create` is given.  folder: where the sweep is stored, None: nowhere yet.
    """

    scenario: Scenario
    starts: List[Start]
    rows: List[Dict[str, Any]]
    meta: Dict[str, Any]
    folder: Optional[Path] = None

    @classmethod
    def of(cls, store: SweepStore, folder: Optional[Path]) -> "SweepResult":
        """Returns what a store holds."""
        return cls(scenario_of(store.meta["setup"]), store.starts(), store.rows(), store.meta, folder)

    @property
    def numbers(self) -> Dict[str, float]:
        """Returns rates of success by each metric, medians of time and error, ... by name (docs/sweeps.md)."""
        return aggregate(self.rows)

    @property
    def success(self) -> Rate:
        """Returns the rate of success of the starts that could be run."""
        numbers = self.numbers
        return Rate(numbers["success"], numbers["success_low"], numbers["success_high"])

    def __str__(self) -> str:
        return format_rows(self.scenario.name, self.rows)

    def plot(self, name: str = "map", axes: Optional[Tuple[str, str]] = None) -> "Figure":
        """Returns a figure: "map" over two columns of the rows, "curve" over the distance, or "reasons" of failures."""
        return make_figure(name, self.rows, axes)

    def save(self, folder: Union[str, Path]) -> Path:
        """Writes sweep.db, runs.csv, figures and sweep.html into a folder. Returns the path of the page."""
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        with SweepStore.create(path, self.meta, self.starts) as store:
            store.add([(row, 0.0) for row in self.rows], {start.id: start for start in self.starts})
            return save_report(store)


@dataclass(frozen=True)
class SweepComparison:
    """Two or more sweeps side by side. Attributes: names, folders, sweeps: rows of each, A first."""

    names: List[str]
    folders: List[str]
    sweeps: List[List[Dict[str, Any]]]

    @property
    def numbers(self) -> Dict[str, float]:
        """Returns numbers by name: `A.success`, `B.mcnemar_p`, ...; those of the last sweep also without its letter."""
        return numbers_of(self.sweeps)

    def __str__(self) -> str:
        return format_comparison(self.names, self.sweeps)

    def holds(self, expression: str) -> bool:
        """Returns whether a condition holds, such as "B.success < A.success", or one of its numbers has no value."""
        return gate_fires(expression, self.numbers)[0]

    def save(self, folder: Union[str, Path]) -> Path:
        """Writes compare.html into a folder. Returns its path."""
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        joints = {}
        if self.folders[0]:
            with SweepStore.open(Path(self.folders[0])) as store:
                joints = joint_units(store.meta["setup"])
        return save_sweeps_page(self.names, self.folders, self.sweeps, [], path, "", joints)


def sweep(scenario: Union[str, Path, Scenario], starts: Optional[int] = None, *, law: Optional[str] = None,
          plugins: Sequence[str] = (), overrides: Optional[Mapping[str, Any]] = None, method: Optional[str] = None,
          space: Optional[str] = None, seed: Optional[int] = None, drive_to_start: Optional[bool] = None,
          workers: Optional[int] = None, scheduler: Optional[str] = None, folder: Union[None, str, Path] = None,
          quiet: bool = False) -> SweepResult:
    """Runs a scenario from many starts. Equal arguments give equal rows, whatever the workers.

    Args:
        scenario: name, path of a YAML file, or `Scenario`.  starts: number of runs.
        law: name of a law to take in place of the scenario's.  plugins: modules that register laws or features.
        overrides: value by dotted path, e.g. {"servo.gains_per_s.xn": 2.0}.
        method, space, seed, drive_to_start: as in the section `sweep` of a scenario; None: the scenario's.
        workers: processes; None: one per core, 0: this one.  scheduler: address of a Dask scheduler instead.
        folder: where the sweep is stored; one that was interrupted there is continued. None: nowhere.
        quiet: do not show progress on stderr.
    Raises: ParameterError: it lists every fault.
    """
    changes = _changes(law, plugins, overrides)
    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario, changes)
    elif changes:
        scenario = scenario.with_overrides(changes)
    kinematics = ServoLoop(scenario).kinematics  # a fault of the scenario is raised here, instead of in every row
    settings = SweepSettings.from_scenario(scenario, kinematics, starts=starts, method=method, space=space, seed=seed,
                                           drive_to_start=drive_to_start)
    planned = make_starts(settings, scenario, kinematics)
    with processes.temporary_folder("aras-sweep-") as temporary:
        with open_sweep(Path(folder or temporary), scenario, planned, settings.as_plain(), "",
                        installed_versions()) as store:
            progress = Progress(len(planned), store.rows(), io.StringIO()) if quiet else None
            run_pending(store, store.meta["setup"], workers, scheduler, progress)
            return SweepResult.of(store, Path(folder) if folder else None)


@dataclass(frozen=True)
class BenchmarkResult:
    """A protocol that was run. Attributes: protocol.  results: (`Case`, rows) of each case."""

    protocol: Protocol
    results: Results

    @property
    def table(self) -> List[List[str]]:
        """Returns the rows of the table, lists of texts, the headings first: rates of success beside the published."""
        return table(self.protocol, self.results)

    def __str__(self) -> str:
        return as_markdown(self.protocol, self.table, "")

    def save(self, folder: Union[str, Path]) -> Path:
        """Writes benchmark.md, benchmark.csv and the pictures into a folder. Returns the path of the first."""
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        self.protocol.save_pictures(self.results, path)
        return save_table(self.protocol, self.table, path, "")


def benchmark(protocol: str, starts: Optional[int] = None, *, cases: Sequence[str] = (), law: Optional[str] = None,
              plugins: Sequence[str] = (), overrides: Optional[Mapping[str, Any]] = None,
              own: Optional[Mapping[str, str]] = None, workers: Optional[int] = None, scheduler: Optional[str] = None,
              folder: Union[None, str, Path] = None, quiet: bool = False) -> BenchmarkResult:
    """Runs a published protocol (docs/benchmarks.md).

    Args:
        protocol: its name.  starts: of each case, spread evenly over those of the protocol; None: all.
        cases: their names or beginnings; (): all.  own: files that take the place of ours, {"board": PATH} or
            {"meshes": FOLDER}.
        law, plugins, overrides, workers, scheduler, folder, quiet: as of `sweep`, for every case. A law that only this
            program registers needs workers=0.
    Raises:
        ParameterError: no such protocol or case, or it lists every fault.
    """
    asked = protocol_named(protocol)
    asked.check_own(own or {})
    faults = load_plugins(plugins)
    if faults:
        raise ParameterError(faults)
    with processes.temporary_folder("aras-benchmark-") as temporary:
        return BenchmarkResult(asked, run_protocol(asked, Path(folder or temporary), starts, cases,
                                                   _changes(law, plugins, overrides), own or {}, "", workers,
                                                   scheduler, quiet))


def _changes(law: Optional[str], plugins: Sequence[str], overrides: Optional[Mapping[str, Any]]) -> Dict[str, Any]:
    """Value by dotted path."""
    return {**({"servo.plugins": list(plugins)} if plugins else {}), **({"servo.law": law} if law else {}),
            **(overrides or {})}


def compare(*sweeps: Union[str, Path, SweepResult]) -> SweepComparison:
    """Compares sweeps on the same starts, each with the first: McNemar's test for success, Wilcoxon's for the rest.

    Args: sweeps: results of `sweep`, or folders of stored sweeps.
    Raises: ParameterError: they have other starts.
    """
    if not 2 <= len(sweeps) <= len(LETTERS):
        raise ParameterError(f"compare: found {len(sweeps)} sweeps, allowed 2 to {len(LETTERS)}")
    results = [one if isinstance(one, SweepResult) else _stored(one) for one in sweeps]
    comparison = SweepComparison([_name(one) for one in results],
                                 [str(one.folder.resolve()) if one.folder else "" for one in results],
                                 [one.rows for one in results])
    numbers_of(comparison.sweeps)  # raises for other starts
    return comparison


def _name(result: SweepResult) -> str:
    scenario = result.scenario
    return result.folder.name if result.folder else f"{scenario.name} {scenario.servo.get('law', '')}".strip()


def _stored(folder: Union[str, Path]) -> SweepResult:
    with SweepStore.open(folder) as store:
        return SweepResult.of(store, store.folder)
