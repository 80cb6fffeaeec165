"""Runs the cases of sweep/stop_rule.py and prints their counts; run it through `script/bench --stop-rule`."""
import argparse
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor

from aras_visual_servo_study.sweep.stop_rule import draw, run_case, tally

COLUMNS = ("runs", "inside", "converged", "false_converged", "missed")


def table(counts):
    """The counts as text, scenarios by name and their sum last."""
    names = sorted(counts, key=lambda name: (name == "all", name))
    lines = [f"{'scenario':<22}" + "".join(f"{column:>17}" for column in COLUMNS)]
    lines += [f"{name:<22}" + "".join(f"{counts[name][column]:>17}" for column in COLUMNS) for name in names]
    return "\n".join(lines)


def main():
    """Exit code 1 if a run converged outside its judge, or 1 % or more of those inside did not converge."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=2050, help="cases drawn; a few cannot be run")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--rows", help="file for one line of JSON per case")
    arguments = parser.parse_args()
    cases, rows = draw(arguments.runs, arguments.seed), []
    with ProcessPoolExecutor(arguments.workers) as pool, open(arguments.rows or os.devnull, "w") as file:
        for row in pool.map(run_case, cases):
            rows.append(row)
            print(json.dumps(row), file=file, flush=True)
    counts = tally(rows)
    print(table(counts))
    count = counts["all"]
    print(f"inside the judge and not CONVERGED: {100.0 * count['missed'] / count['inside']:.2f} % of those inside")
    return int(count["false_converged"] > 0 or count["missed"] >= 0.01 * count["inside"])


if __name__ == "__main__":
    sys.exit(main())
