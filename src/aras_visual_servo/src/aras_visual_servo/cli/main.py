"""The command `aras-servo VERB ...`. Each verb is a function in the package that does the work."""

import importlib
import os
import sys
from typing import Dict, List, Optional, Tuple

#: verb -> (module, function); a module is imported only when its verb is used.
VERBS: Dict[str, Tuple[str, str]] = {
    "run": ("aras_visual_servo.cli.run", "run_main"),
    "report": ("aras_visual_servo.cli.run", "report_main"),
    "live": ("aras_visual_servo_study.cli.live", "live_main"),
    "sweep": ("aras_visual_servo_study.cli.sweep", "sweep_main"),
    "rerun": ("aras_visual_servo_study.cli.sweep", "rerun_main"),
    "compare": ("aras_visual_servo_study.cli.sweep", "compare_main"),
    "compare_laws": ("aras_visual_servo_study.cli.compare", "compare_laws_main"),
    "compare_runs": ("aras_visual_servo_study.cli.compare", "compare_runs_main"),
    "benchmark": ("aras_visual_servo_study.cli.benchmark", "benchmark_main"),
    "calibrate": ("aras_visual_servo_controller.cli.calibrate", "calibrate_main"),
}


def main(argv: Optional[List[str]] = None) -> int:
    """Runs one verb. Returns the exit code."""
    words = sys.argv[1:] if argv is None else argv
    if not words or words[0] not in VERBS:
        print("usage: aras-servo VERB ...; verbs: " + ", ".join(VERBS), file=sys.stderr)
        return 2
    module, function = VERBS[words[0]]
    return getattr(importlib.import_module(module), function)(words[1:])


def alias_main() -> int:
    """`rosrun aras_visual_servo_controller VERB ...`: the verb is the name of the program."""
    return main([os.path.basename(sys.argv[0]), *sys.argv[1:]])
