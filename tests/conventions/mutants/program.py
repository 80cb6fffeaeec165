"""The command of script/mutate: would the tests notice?"""
import argparse
import sys

import cpp_module
import operators
import python_module

EXAMPLES = """examples:
  script/mutate laws                      forty mutants of the room laws
  script/mutate servo/stop_rule --seed 3  of one file, others
  script/mutate rasteriser                those of tests/conventions/mutants/rasteriser.yaml
"""


def main():
    """Entry. Returns 0 if at least the asked part of the mutants died, 1 if fewer did, 2 for a bad module."""
    lists = ", ".join(cpp_module.modules())
    parser = argparse.ArgumentParser(
        prog="script/mutate", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Plants small faults in a module, one at a time, in a throw-away copy, runs the module's own unit "
        "tests,\nand prints which faults survived: no test noticed them.\n\n" + operators.__doc__,
        epilog=EXAMPLES)
    parser.add_argument("module", help="a room, folder or file of the controller's package (laws, arm/real, "
                        f"servo/stop_rule), or one with a list of mutants of its C++: {lists}")
    parser.add_argument("--count", type=int, default=40, help="mutants of a Python module (default: 40)")
    parser.add_argument("--seed", type=int, default=0, help="which of them are drawn (default: 0)")
    parser.add_argument("--least", type=float, default=92.0, help="percent that must die (default: 92)")
    arguments = parser.parse_args()

    def say(text):
        print(text, flush=True)

    try:
        if arguments.module in cpp_module.modules():
            killed, survivors = cpp_module.run(arguments.module, say)
        else:
            python_module.preload()
            killed, survivors = python_module.run(arguments.module, arguments.count, arguments.seed, say)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    percent = 100.0 * killed / max(1, killed + len(survivors))
    say(f"{arguments.module}: {killed} of {killed + len(survivors)} killed, {percent:.0f} %, {len(survivors)} survived")
    for text in survivors:
        say(f"  {text}")
    return 0 if percent >= arguments.least else 1


if __name__ == "__main__":
    sys.exit(main())
