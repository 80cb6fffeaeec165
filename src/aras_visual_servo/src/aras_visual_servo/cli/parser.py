"""What the commands share: a parser whose --help ends with examples, and tab completion by argcomplete."""

import argparse

PACKAGE = "aras_visual_servo_controller"
PREFIX = f"rosrun {PACKAGE}"
#: Where completion offers names: an argument of this name is completed by this function.
_COMPLETE = {"scenario": lambda prefix: _scenarios(prefix), "overrides": lambda prefix: _keys(prefix)}


def command_parser(prog, description, examples, package=PACKAGE):
    """Parser of a command.

    Args: prog: its name.  examples: lines to type, (arguments, what they do) each; shown at the end of --help.
        package: that has the command.
    """
    text = "\n".join(f"  # {what}\n  rosrun {package} {prog} {line}" for line, what in examples)
    return argparse.ArgumentParser(prog=prog, description=description, epilog=f"examples:\n{text}",
                                   formatter_class=_Help)


def parse(parser, argv=None):
    """The arguments; or, if the shell asks for it, what the word under the cursor may become (python3-argcomplete)."""
    try:
        import argcomplete
    except ImportError:  # nothing but the completion is missing then
        return parser.parse_args(argv)
    for action in parser._actions:
        if action.dest in _COMPLETE:
            action.completer = _completer(_COMPLETE[action.dest])
    argcomplete.autocomplete(parser)
    return parser.parse_args(argv)


class _Help(argparse.HelpFormatter):
    """Wraps everything but the examples."""

    def _fill_text(self, text, width, indent):
        return text if text.startswith("examples:") else super()._fill_text(text, width, indent)


def _completer(words):
    return lambda prefix, **_: words(prefix)


def _scenarios(prefix):
    """Shipped scenarios, and YAML files in the folder that is typed."""
    import os
    from pathlib import Path
    from ..scenario.files import scenario_names
    folder = os.path.dirname(prefix)
    found = sorted(Path(folder or ".").glob("*.yaml")) + [path for path in Path(folder or ".").iterdir()
                                                          if folder and path.is_dir()]
    files = [os.path.join(folder, path.name) + "/" * path.is_dir() for path in found]
    return [name for name in [*scenario_names(), *files] if name.startswith(prefix)]


def _keys(prefix):
    """Dotted keys of the scenario's schema, one level at a time, with = where a value comes next."""
    from ..config.tables import section_of
    from ..scenario.schema import scenario_schema
    *above, _ = prefix.split(".")
    schema = scenario_schema()
    for key in above:
        schema = section_of(schema).get("properties", {}).get(key, {})
    found = section_of(schema).get("properties", {})
    start = "".join(key + "." for key in above)
    return [f"{start}{key}" + ("." if section_of(value).get("properties") or isinstance(
        value.get("additionalProperties"), dict) else "=") for key, value in found.items()]
