"""The word `robot meshes`: a named arm with the meshes of the vendor's description package."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from . import EXIT_PASSED, Command, command_line, file, scenario_name, write_new

URDF, SCENARIO, CONTROLLERS = "arm.urdf", "scenario.yaml", "controllers.yaml"
HEAD = "# The arm {name} with the meshes of {description}. It goes where {name} goes.\n"


def _options(parser: ArgumentParser) -> None:
    parser.add_argument("robot", type=scenario_name, metavar="NAME", help="a named arm, or the scenario file of one")
    parser.add_argument("--description", required=True, type=file, metavar="PATH",
                        help="the vendor's description package, or its expanded URDF; the files stay where they are")
    parser.add_argument("--folder", metavar="FOLDER", type=file, help="where the files go (default: a new folder NAME)")


def _work(arguments: Namespace) -> int:
    import yaml
    from ..arm.description import with_meshes
    from ..scenario.scenario import load_scenario
    scenario = load_scenario(arguments.robot)
    text = with_meshes(scenario.urdf_path.read_text(encoding="utf-8"), arguments.description)
    folder = Path(arguments.folder or file(scenario.name))
    document = {"name": scenario.name, "description": scenario.description, "extends": arguments.robot,
                "robot": {"urdf": URDF, "controllers": CONTROLLERS}}
    made = {URDF: text, CONTROLLERS: scenario.controllers_path.read_text(encoding="utf-8"),
            SCENARIO: HEAD.format(name=scenario.name, description=arguments.description)
            + yaml.safe_dump(document, sort_keys=False)}
    write_new(folder, made)
    print(f"{folder}: {', '.join(made)} written; look at it:  {command_line('live', folder / SCENARIO)}")
    return EXIT_PASSED


COMMAND = Command("Give a named arm the meshes of the vendor's description package, by path.",
                  [("ur5e --description ur5e.urdf --folder ur5e_meshes", "of a URDF that xacro expanded")],
                  _options, _work)
