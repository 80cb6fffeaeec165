"""The verb `scenario list | show | new | check | keys`."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from . import EXIT_FAILED, EXIT_PARAMETERS, EXIT_PASSED, Command, add_changes, add_scenario, check_name, \
    command_line, file, scenario_name, scenario_of
from ..ground.errors import ParameterError

#: Rows farther from the differences than this part of them are wrong.
MOST_OFF = 0.05


def _list(arguments: Namespace) -> int:
    from ..config.files import arm_names, scenario_names
    from ..scenario.scenario import load_scenario
    for name in [*scenario_names(), *arm_names()]:
        print(f"{name:<28} {load_scenario(name).description}")
    return EXIT_PASSED


def _show_options(parser: ArgumentParser) -> None:
    add_scenario(parser)
    parser.add_argument("--plain-robot", action="store_true",
                        help="refuse robot.dynamics, for launch files: they load URDF and controllers as the files are")


def _show(arguments: Namespace) -> int:
    scenario = scenario_of(arguments)
    if arguments.plain_robot and scenario.robot.get("dynamics"):
        again = command_line("run", arguments.scenario, "--ros")
        raise ParameterError("robot.dynamics: found friction, loops or a payload, allowed none in servo.launch, which "
                             f"loads URDF and controllers as the files are: start it with {again}")
    print(scenario.as_yaml(), end="")
    return EXIT_PASSED


def _new_options(parser: ArgumentParser) -> None:
    parser.add_argument("new", metavar="NAME", help="NAME.yaml is written in this folder")
    parser.add_argument("scenario", nargs="?", default="experiment_1", metavar="SCENARIO",
                        help="name or path of the scenario that it extends (default: experiment_1)")


def _new(arguments: Namespace) -> int:
    from ..scenario.starter import starter
    name = arguments.new[:-len(".yaml")] if arguments.new.endswith(".yaml") else arguments.new
    check_name(name, "NAME")
    path = Path(file(f"{name}.yaml"))
    text = starter(name, arguments.scenario, path)
    try:
        with open(path, "x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise ParameterError(f"NAME: {path} is there already; choose another name") from None
    print(f"{path.name} is written; run it:  {command_line('run', path)}")
    return EXIT_PASSED


def _check_options(parser: ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", type=scenario_name, metavar="SCENARIO", help="names or paths")
    add_changes(parser)


def _check(arguments: Namespace) -> int:
    from ..scenario.feasibility import check_feasible, check_workspace
    code = EXIT_PASSED
    for name in arguments.files:
        try:
            scenario = scenario_of(Namespace(**{**vars(arguments), "scenario": name}))
            check_feasible(scenario)
            check_workspace(scenario)
            print(f"{name}: ok")
        except ParameterError as error:
            print(f"{name}:\n{error}")
            code = EXIT_PARAMETERS
    return code


def _keys_options(parser: ArgumentParser) -> None:
    parser.add_argument("section", nargs="?", default="", help="dotted name of a section, e.g. servo.stop")


def _keys(arguments: Namespace) -> int:
    from ..config.tables import allowed_of, section_of
    from ..scenario.schema import scenario_schema
    node = scenario_schema()
    for key in [part for part in arguments.section.split(".") if part]:
        known = section_of(node).get("properties", {})
        if key not in known:
            raise ParameterError(f"{arguments.section}: found '{key}', allowed {', '.join(known) or 'no key'}")
        node = known[key]
    for key, value in section_of(node).get("properties", {}).items():
        kind = "section" if section_of(value).get("properties") else allowed_of(value).replace("\\|", "|")
        default = f", default {value['default']}" if "default" in value else ""
        unit = f" [{value['unit']}]" if value.get("unit") else ""
        print(f"{key}{unit}: {kind.replace('`', '')}{default}\n    {' '.join(value.get('description', '').split())}")
    return EXIT_PASSED


def _rows(arguments: Namespace) -> int:
    from ..runs.rows import check_rows
    found, code = check_rows(scenario_of(arguments), arguments.views), EXIT_PASSED
    for name, deviation in found.deviation.items():
        wrong = found.columns(name, MOST_OFF / 6.0**0.5) if deviation > MOST_OFF else {}
        code = EXIT_FAILED if deviation > MOST_OFF else code
        print(f"{name:<12} {100 * deviation:6.1f} %" + "".join(
            f"\n    {column}: row {row:.4g}, differences {difference:.4g}"
            for column, (row, difference) in wrong.items()))
    return code


def _rows_options(parser: ArgumentParser) -> None:
    add_scenario(parser)
    parser.add_argument("--views", type=int, default=4, help="number of views about the goal (default: 4)")


VERBS = {"scenario": {
    "list": Command("List the scenarios and arms that come with the package.", [("", "all names, described")],
                    lambda parser: None, _list),
    "show": Command("Print a scenario as it runs, with the scenarios that it extends and all changes.",
                    [("experiment_2 --set sim.seed=3", "with another seed"), ("mine.yaml", "a file of your own")],
                    _show_options, _show),
    "new": Command("Write a commented starter scenario. It extends another one and lists every key with its "
                   "meaning.", [("mine", "mine.yaml, which extends experiment_1"),
                                ("mine six_dof_points", "it extends another one")], _new_options, _new),
    "check": Command("Check scenarios and print every fault with its file and line.",
                     [("mine.yaml", "a file of your own"), ("experiment_1 --law ibvs", "with another law")],
                     _check_options, _check),
    "rows": Command("Compare each feature's row of the interaction matrix with central differences of its value in "
                    "rendered images, in tilted views about the goal. Prints how far they are apart, as a part of the "
                    f"differences; above {100 * MOST_OFF:g} % also the columns, and the exit code is 1.",
                    [("mine.yaml", "features of a file of your own"), ("six_dof_points --views 10", "more views")],
                    _rows_options, _rows),
    "keys": Command("Print the keys of a section: unit, allowed values, default, meaning.",
                    [("servo", "the keys of a section"), ("servo.stop", "the keys of a subsection")],
                    _keys_options, _keys),
}}
