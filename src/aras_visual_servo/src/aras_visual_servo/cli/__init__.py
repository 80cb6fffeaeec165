"""Shared parts of the verbs of `aras-servo`: help with examples, options, exit codes, and repeat lines.

Exit codes: 0 done, or the run passed; 1 it did not pass; 2 bad input; 3 could not run; 128 + N ended by signal N.
"""

import argparse
import os
import re
import select
import shlex
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import yaml

from . import complete
from ..config.plugins import described, load_plugins, code_place, placed
from ..ground.errors import ArasError, ParameterError
from ..ground.extras import DEBIAN_PACKAGES
from ..processes import EXIT_SIGNALLED, Interrupted, signals_raise

PROGRAM = "aras-servo"
EXIT_PASSED, EXIT_FAILED, EXIT_PARAMETERS, EXIT_BROKEN = range(4)
#: Options that the repeat line omits: places of results, and distribution of the work.
NOT_REPEATED = ("output", "name", "workers", "scheduler", "resume", "results", "verbose", "open")


@dataclass(frozen=True)
class Command:
    """One verb, or one word of a verb that has several.

    Attributes:
        about: description; lists of commands print the first sentence.
        examples: (arguments, description) each, printed at the end of --help.
        options: adds its arguments to a parser.  work: does it and returns the exit code; the parsed arguments have
        `repeat` too, the line that repeats the command from any folder.
    """

    about: str
    examples: Sequence[Tuple[str, str]]
    options: Callable[[argparse.ArgumentParser], None]
    work: Callable[[argparse.Namespace], int]


#: A verb: one command, or several by their words.
Verb = Union[Command, Dict[str, Command]]


def parser_of(prog: str, verb: Verb) -> argparse.ArgumentParser:
    """Returns the parser of a verb. Args: prog: as it is typed, e.g. `aras-servo run`."""
    parser = argparse.ArgumentParser(prog=prog, formatter_class=_Help)
    if isinstance(verb, Command):
        _fill(parser, verb)
        return parser
    parser.epilog = _examples((prog + " " + word, command.examples[:1]) for word, command in verb.items())
    words = parser.add_subparsers(metavar="WORD", required=True)
    for word, command in verb.items():
        _fill(words.add_parser(word, help=command.about.partition(". ")[0].rstrip("."), formatter_class=_Help), command)
    return parser


def run_verb(prog: str, verb: Verb, argv: Optional[Sequence[str]] = None) -> int:
    """Parses the arguments and does the work. Returns the exit code; an error is printed."""
    parser = parser_of(prog, verb)
    complete.offer(parser)
    arguments = parser.parse_args(argv)
    arguments.repeat = repeat_line(arguments)

    def work() -> int:
        workers, name = getattr(arguments, "workers", None), getattr(arguments, "name", None)
        if workers is not None and workers < 0:
            raise ParameterError(f"--workers: found {workers}, allowed >= 0")
        if name is not None:
            check_name(name, "--name")
        return arguments.command.work(arguments)
    return guarded(work)


def guarded(work: Callable[[], int]) -> int:
    """Returns the exit code of work(). If it raises, the reason is printed and the code says which kind it is."""
    try:
        with signals_raise():
            return work()
    except ParameterError as error:
        print(f"bad input:\n{code_place(error)}{error}", file=sys.stderr)
        return EXIT_PARAMETERS
    except Interrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return interrupt.exit_code
    except Exception as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            raise
        place, expected = code_place(error), isinstance(error, (ArasError, ImportError, RuntimeError, OSError))
        if not (place or expected):
            raise
        package = DEBIAN_PACKAGES.get(getattr(error, "name", None) or "")
        print(f"error: {f'{place}{error}' if expected else described(error)}"
              + (f"; `apt install {package}` installs it" if package else ""), file=sys.stderr)
        return EXIT_BROKEN


def quiet_without_reader(work: Callable[[], int]) -> int:
    """Returns the exit code of work(), or that of SIGPIPE if the reader of standard output has gone (`| head`)."""
    try:
        try:
            return work()
        finally:
            print(end="", flush=True)
    except BrokenPipeError:
        if not _nobody_reads():
            raise
        # Python flushes again when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_SIGNALLED + signal.SIGPIPE


def _nobody_reads() -> bool:
    """Whether standard output is a pipe whose reader has gone."""
    output = select.poll()
    try:
        output.register(sys.stdout.fileno(), 0)
    except (AttributeError, OSError, ValueError):  # no stream, or one without a file
        return False
    return any(event & select.POLLERR for _, event in output.poll(0))


def repeat_line(arguments: argparse.Namespace) -> str:
    """Returns the line that gives the same result from any folder: without options that do not change it."""
    words: List[str] = []
    for action in arguments.parser._actions:
        value = getattr(arguments, action.dest, None)
        if action.dest in NOT_REPEATED or value in (None, False, [], ()) or value == action.default:
            continue
        values = [",".join(value)] if isinstance(value, tuple) else \
            list(map(str, value)) if isinstance(value, list) else [str(value)]
        option = action.option_strings[:1]
        if value is True:
            words += option
        elif isinstance(action, argparse._AppendAction):
            words += [word for one in values for word in (*option, one)]
        elif option and values[0].startswith("-"):
            words.append(f"{option[0]}={values[0]}")
        else:
            words += [*option, *values]
    return command_line(*arguments.parser.prog.split()[1:], *words)


def command_line(*words: Any) -> str:
    """Returns a line to type: `aras-servo` and these words, quoted."""
    return shlex.join([PROGRAM, *map(str, words)])


def file(text: str) -> str:
    """Returns the absolute path of a file or folder that was typed."""
    return os.path.abspath(os.path.expanduser(text))


def write_new(folder: Path, made: Mapping[str, str]) -> None:
    """Writes files, name -> text, into a folder. Raises ParameterError: one of them is there already."""
    there = [str(folder / each) for each in made if (folder / each).exists()]
    if there:
        raise ParameterError(f"--folder: found {', '.join(there)} already, allowed a folder without these")
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in made.items():
        (folder / name).write_text(content, encoding="utf-8")


def scenario_name(text: str) -> str:
    """Returns the name of a scenario, or the absolute path of a scenario file."""
    return file(text) if os.sep in text or text.endswith((".yaml", ".yml")) else text


def check_name(name: str, option: str) -> None:
    """Raises ParameterError: this is no name of a scenario or of a result folder."""
    from ..scenario.schema import NAME
    if not re.fullmatch(NAME, name):
        raise ParameterError(f"{option}: found '{name}', allowed letters, digits, _ . -, not only dots")


def names(text: str) -> Tuple[str, ...]:
    """Returns the names of a list with commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def add_scenario(parser: argparse.ArgumentParser, **more: Any) -> None:
    """Adds SCENARIO and the options that change it: --law, --plugins, --set."""
    parser.add_argument("scenario", type=scenario_name, metavar="SCENARIO",
                        help="name of a shipped scenario (`aras-servo scenario list`), or path of a YAML file", **more)
    add_changes(parser)


def add_changes(parser: argparse.ArgumentParser, law: bool = True) -> None:
    """Adds --law (unless the command has a list of laws), --plugins and --set."""
    if law:
        parser.add_argument("--law", metavar="NAME", help="control law in place of the scenario's, e.g. ibvs")
    parser.add_argument("--plugins", action="append", default=[], type=lambda text: placed(text, "."),
                        metavar="MODULE", help="Python module with laws or features of your own; looked for in this "
                        "folder, then on PYTHONPATH; may be given several times")
    parser.add_argument("--set", action="append", default=[], type=_setting, metavar="KEY=VALUE", dest="overrides",
                        help="replace a value of the scenario, e.g. --set servo.gains_per_s.xn=2.0; may be given "
                             "several times")


def changes_of(arguments: argparse.Namespace) -> Dict[str, Any]:
    """Returns the changes of --law, --plugins and --set, dotted path -> value. Imports the plugins.

    Raises:
        ParameterError: a text of --set is not KEY=VALUE, or a plugin cannot be imported.
    """
    changes: Dict[str, Any] = {}
    if arguments.plugins:
        changes["servo.plugins"] = arguments.plugins
    if getattr(arguments, "law", None):
        changes["servo.law"] = arguments.law
    changes.update(parse_overrides(arguments.overrides))
    faults = load_plugins(arguments.plugins)
    if faults:
        raise ParameterError(faults)
    return changes


def scenario_of(arguments: argparse.Namespace) -> Any:
    """Returns the `Scenario` that is named, with its changes. Its own plugins stay beside those of --plugins."""
    from ..scenario.scenario import load_scenario
    changes = changes_of(arguments)
    if arguments.plugins:
        own = load_scenario(arguments.scenario).servo.get("plugins", [])
        changes["servo.plugins"] = [*own, *(name for name in changes["servo.plugins"] if name not in own)]
    return load_scenario(arguments.scenario, changes)


def parse_overrides(texts: Sequence[str]) -> Dict[str, Any]:
    """Returns dotted path -> value of texts KEY=VALUE, values in YAML. Raises ParameterError with all bad ones."""
    overrides, faults = {}, []
    for text in texts:
        key, equals, value = text.partition("=")
        try:
            if not equals or not key:
                raise ValueError
            overrides[key] = yaml.safe_load(value)
        except (ValueError, yaml.YAMLError):
            faults.append(f"--set {text}: allowed is KEY=VALUE, e.g. sim.seed=3")
    if faults:
        raise ParameterError(faults)
    return overrides


def add_output(parser: argparse.ArgumentParser, below: str = "") -> None:
    """Adds --output and, where results go to DIR/`below`/NAME, --name."""
    parser.add_argument("--output", default="results", type=lambda text: os.path.expanduser(text), metavar="DIR",
                        help="folder under which result folders are made (default: results)")
    if below:
        parser.add_argument("--name", help=f"name of the folder DIR/{below}/NAME (default: the time)")


def add_workers(parser: argparse.ArgumentParser, scheduler: bool = True) -> None:
    """Adds --workers and --scheduler."""
    parser.add_argument("--workers", type=int, metavar="N",
                        help="worker processes on this machine (default: one per core; 0: run in this process)")
    if scheduler:
        parser.add_argument("--scheduler", metavar="ADDRESS",
                            help="Dask scheduler whose workers do the runs, e.g. tcp://host:8786")


def _setting(text: str) -> str:
    """The text of --set; modules of servo.plugins with their folders."""
    key, _, value = text.partition("=")
    if key == "servo.plugins":
        try:
            value = yaml.safe_dump([placed(name, ".") for name in yaml.safe_load(value)], default_flow_style=True)
        except (yaml.YAMLError, TypeError, AttributeError):
            return text  # its fault is reported with those of the scenario
        return f"{key}={value.strip()}"
    return text


def _fill(parser: argparse.ArgumentParser, command: Command) -> None:
    parser.description, parser.epilog = command.about, _examples([(parser.prog, command.examples)])
    command.options(parser)
    parser.set_defaults(command=command, parser=parser)


def _examples(of: Any) -> str:
    lines: Iterator[str] = (f"  # {what}\n  {prog} {line}" for prog, examples in of for line, what in examples)
    return "examples:\n" + "\n".join(lines)


class _Help(argparse.HelpFormatter):
    """Wraps everything but the examples."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith("examples:") else super()._fill_text(text, width, indent)
