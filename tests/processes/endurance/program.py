"""The command of script/endurance: what a long run finds and a short one does not."""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "support")]

import determinism
import soak

from aras_visual_servo.processes import signals_raise


def main():
    """Entry. Returns the exit code."""
    parser = argparse.ArgumentParser(prog="script/endurance",
                                     description="What a long run finds and a short one does not.")
    commands = parser.add_subparsers(dest="command", required=True)
    for module in (determinism, soak):
        command = commands.add_parser(module.__name__, help=module.__doc__.splitlines()[0], description=module.__doc__,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
        module.add_arguments(command)
        command.set_defaults(main=module.main)
    arguments = parser.parse_args()
    with signals_raise():
        return arguments.main(arguments)


if __name__ == "__main__":
    sys.exit(main())
