"""The command `aras-servo VERB ...`. Each verb is described by the package that does its work."""

import argparse
import os
import sys
from pathlib import Path
from typing import Dict, List, Optional, Tuple

from . import EXIT_BROKEN, PROGRAM, Verb, complete, guarded, quiet_without_reader, run_verb
from ..config.files import package_version
from ..studies import sister

CORE, ROS, STUDY = "aras_visual_servo", "aras_visual_servo_controller", "aras_visual_servo_study"
LEARNING = "aras_visual_servo_learning"
#: verb -> (package, module of its folder `cli`, description). The module defines the verb in a dict VERBS.
VERBS: Dict[str, Tuple[str, str, str]] = {
    "run": (CORE, "run", "run a scenario, judge it by the true camera pose, and write a report"),
    "live": (STUDY, "live", "watch and change a run on a page"),
    "report": (STUDY, "report", "make the report of a run again from its bag"),
    "sweep": (STUDY, "sweep", "run a scenario from many starts"),
    "rerun": (STUDY, "sweep", "repeat one run of a sweep, with its report"),
    "compare": (STUDY, "compare", "compare sweeps, laws or single runs"),
    "benchmark": (STUDY, "benchmark", "run a published protocol and write its table"),
    "export": (LEARNING, "export", "write runs and sweeps as a data set, as MCAP or as a bag of ROS 2"),
    "calibrate": (ROS, "calibrate", "calibrate a camera, its place on the arm, or the plane of the target"),
    "identify": (ROS, "identify", "identify an arm from a bag, or design a motion that tells its parameters"),
    "replay-on-twin": (STUDY, "replay_on_twin", "repeat a recorded run on the twin of its arm"),
    "robot": (CORE, "robot", "print, check and add arms"),
    "ros2": (ROS, "ros2", "relay a running simulator to ROS 2 nodes, and run such nodes"),
    "scenario": (CORE, "scenario", "list, show, check and write new scenarios; print their keys"),
}
#: The word of a verb that may be left out.
USUAL = {"robot": "show", "ros2": "relay"}
#: Verbs that may be typed alone, because their usual word needs no arguments.
ALONE = ("ros2",)


def main(argv: Optional[List[str]] = None) -> int:
    """Runs one verb. Returns the exit code."""
    return quiet_without_reader(lambda: _main(argv))


def _main(argv: Optional[List[str]]) -> int:
    words = list(sys.argv[1:] if argv is None else argv)
    other = other_installation(sys.argv[0])
    if argv is None and other is not None:
        print(f"error: {sys.argv[0]} belongs to {other}, but Python finds {Path(__file__).parents[1]} first: leave the "
              "virtual environment, or the shell that sourced a workspace", file=sys.stderr)
        return EXIT_BROKEN
    typed = os.environ.get("COMP_LINE", "")[:int(os.environ.get("COMP_POINT", 0))].split(" ")
    if "_ARGCOMPLETE" in os.environ and len(typed) > 2 and typed[1] in VERBS:
        os.environ["_ARGCOMPLETE"], words = "2", [typed[1]]  # the words before the verb's own
    if words and words[0] in VERBS:
        return guarded(lambda: _run(words[0], words[1:]))
    parser = argparse.ArgumentParser(
        prog=PROGRAM, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Visual servoing: run, watch, sweep and compare scenarios.",
        epilog="verbs:\n" + "\n".join(f"  {verb:<16}{what}" for verb, (_, _, what) in VERBS.items())
               + f"\n\n`{PROGRAM} VERB --help` explains a verb and ends with examples.")
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {package_version()}")
    parser.add_argument("verb", choices=list(VERBS), metavar="VERB ...", help="what to do")
    complete.offer(parser)
    parser.parse_args(words)
    return 0


def other_installation(program: str) -> Optional[Path]:
    """Returns the folder of this package beside PREFIX/bin/PROGRAM, if another one was imported; else None."""
    prefix = Path(program).resolve().parent.parent
    beside = [path.resolve() for path in prefix.glob(f"lib/python3*/*-packages/{CORE}")]
    return beside[0] if beside and Path(__file__).resolve().parents[1] not in beside else None


def _run(name: str, words: List[str]) -> int:
    verb = verb_named(name)
    left_out = words[0] not in (*verb, "-h", "--help") if words and isinstance(verb, dict) else name in ALONE
    if name in USUAL and left_out:
        words = [USUAL[name], *words]
    return run_verb(f"{PROGRAM} {name}", verb, words)


def verb_named(name: str) -> Verb:
    """Returns a verb. Raises ArasError: the package that has it is not installed."""
    package, module, _ = VERBS[name]
    return sister(package, f"cli.{module}", f"`{PROGRAM} {name}`").VERBS[name]


def alias_main() -> int:
    """`rosrun aras_visual_servo_controller VERB ...` with the verbs and defaults of 2026. Returns the exit code."""
    return main(as_of_2026(os.path.basename(sys.argv[0]), sys.argv[1:]))


def as_of_2026(verb: str, words: List[str]) -> List[str]:
    """Returns the arguments of `aras-servo` for a command of 2026: `run` went over ROS, and had --list and others."""
    if verb in ("compare", "compare_laws", "compare_runs"):
        return ["compare", verb.partition("_")[2] or "sweeps", *words]
    if verb != "run":
        return [verb, *words]
    parser = argparse.ArgumentParser(add_help=False)
    for option in ("--in-process", "--list", "--resolve"):
        parser.add_argument(option, action="store_true")
    parser.add_argument("--init", nargs=1)
    asked, rest = parser.parse_known_args(words)
    if asked.list:
        return ["scenario", "list"]
    if asked.init:
        return ["scenario", "new", *asked.init, *rest]
    if asked.resolve:
        return ["scenario", "show", *rest]
    return ["run", *([] if asked.in_process else ["--ros"]), *rest]
