"""Figures of README.md and docs/: docs/figures.yaml says what they are, what makes them and where they stand.

    runs:                          # by name, those that are not just a scenario
      follow_circle: {scenario: moving_target, set: {KEY: VALUE}, motion: {type: circle, ...}}
    figures:                       # by name
      six_dof_points.x_mm: {value: 0.06, made_by: run, tolerance: 0.02}
      loop: {value: 113, made_by: 'script/bench: whole loop in process, simulated / wall seconds, one core'}
    texts:                         # word for word, {name:format} stands for a figure, lines may break anywhere
    - {file: README.md, text: 'at {loop:.0f} times real time'}
    exceptions:                    # by reason, numbers with a unit that no text above states
      published by others:
      - {file: README.md, text: the published 1.41 rad, which is f = 188 px}
      a test of its own holds it:
      - {file: README.md, table: the first words of a table}      # or paragraph

tests/conventions/test_measured_numbers.py finds numbers with a unit that stand neither here nor in a marked table.

What makes a figure:

- `run`: the name is RUN.KEY, RUN of `runs` or a scenario, KEY one of RUN_KEYS. These are the same on every machine, but
  for rounding, and a test makes them again (tests/closed_loop/test_figures_of_runs.py).
- `table`: the name is TABLE.LAW.TASK.KEY, a cell of docs/comparison.md, KEY one of CELL_KEYS.
- `test PATH::NAME`: the test NAME asserts this very number, which a test checks in its source.
- `script/bench: ROW`: a row of what script/bench prints.
- Anything else is a command that a person runs.

Timings and commands are held only to be the same here and in the text.
Formats are those of Python, and `t`: a whole number of three digits and noughts, thousands apart; `p`: as 1e-7.
"""
import argparse
import json
import pathlib
import re

import yaml

import figure_sources as sources

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = ROOT / "docs" / "figures.yaml"
HEADER = ("# Figures of README.md and docs/, what makes them, and the texts that state them. `script/figures` renews\n"
          "# this file and the texts; script/docs/figures.py says how to read it.\n")
_FIGURE = re.compile(r"\{([\w.]+):([^}]*)\}")


def load(path=LIST):
    """{figures: {name: {value, made_by, tolerance}}, texts: [{file, text}]}"""
    listed = yaml.safe_load(path.read_text())
    for figure in listed["figures"].values():
        figure["value"] = json.loads(str(figure["value"]))  # YAML takes JSON's 1e-07 for a text
    return {part: listed.get(part, {}) for part in ("runs", "figures", "texts", "exceptions")}


def shown(value, form):
    """A figure as the text has it."""
    if form == "p":
        return f"{value:.0e}".replace("e-0", "e-")
    return f"{float(f'{value:.3g}'):,.0f}".replace(",", " ") if form == "t" else format(value, form)


def say(text, figures):
    """The words of a text with the values in the places of their names. KeyError: a figure that is not listed."""
    return _FIGURE.sub(lambda match: shown(figures[match[1]]["value"], match[2]), text)


def names_in(text):
    """Names of the figures of a text."""
    return [match[1] for match in _FIGURE.finditer(text)]


def pattern(words):
    """What finds these words, wherever lines break."""
    return re.compile(r"\s+".join(map(re.escape, words.split())))


def renew(listed, made, root=ROOT):
    """Put what was made into the list and into the texts. Returns [(name, before, now)] of what changed."""
    before = {text["text"]: say(text["text"], listed["figures"]) for text in listed["texts"]}
    changes = []
    for name, value in made.items():
        value = float(f"{value:.4g}")
        if value != listed["figures"][name]["value"]:
            changes.append((name, listed["figures"][name]["value"], value))
            listed["figures"][name]["value"] = value
    for text in listed["texts"]:
        words = say(text["text"], listed["figures"])
        if words != before[text["text"]]:
            page = root / text["file"]
            new, count = pattern(before[text["text"]]).subn(lambda _, words=words: words, page.read_text())
            if count != 1:
                raise SystemExit(f"figures: {text['file']}: found {count} times '{before[text['text']]}', allowed once")
            page.write_text(new)
    return changes


def save(listed, path=LIST):
    lines = [HEADER]
    for part in ("runs", "figures"):
        lines += [f"{part}:{'' if listed[part] else ' {}'}\n"]
        lines += [f"  {name}: {json.dumps(entry)}\n" for name, entry in listed[part].items()]
    lines += ["texts:\n", *(f"- {json.dumps(text)}\n" for text in listed["texts"])]
    lines += [f"exceptions:{'' if listed['exceptions'] else ' {}'}\n"]
    for reason, entries in listed["exceptions"].items():
        lines += [f"  {json.dumps(reason)}:\n", *(f"  - {json.dumps(entry)}\n" for entry in entries)]
    path.write_text("".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", metavar="FILE", type=pathlib.Path, help="what script/bench --figures FILE wrote")
    parser.add_argument("--sweep", metavar="FOLDER", action="append", default=[],
                        help="folder of a sweep whose figures docs/sweeps.md states; may be given several times")
    parser.add_argument("--stop-rule", metavar="FILE", type=pathlib.Path,
                        help="what script/bench --stop-rule RUNS --rows FILE wrote")
    listed = load()
    arguments = parser.parse_args()
    made = {**sources.made_by_tables(listed["figures"]), **sources.made_by_runs(listed)}
    for folder in arguments.sweep:
        made.update(sources.made_by_sweep(listed["figures"], folder))
    if arguments.stop_rule:
        made.update(sources.made_by_stop_rule(listed["figures"], arguments.stop_rule))
    if arguments.bench:
        made.update(sources.made_by_bench(listed["figures"], json.loads(arguments.bench.read_text())))
    for name, before, now in renew(listed, made):
        print(f"{name}: {before:g} -> {now:g}")
    save(listed)


if __name__ == "__main__":
    main()
