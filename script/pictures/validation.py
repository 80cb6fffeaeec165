"""Writes what tests compared into the tables of docs/validation.md, and reads these tables. See script/validation."""
import json
import pathlib
import re
import sys

import marked

#: A table of the page stands between these lines; the group is whose tests fill it.
BEGIN, END = "<!-- compared: {} -->", "<!-- end compared -->"
HEAD = "| what | against | cases | worst difference | allowed |\n|---|---|---|---|---|\n"


def read(page):
    """{(what, against): {cases, worst, bound, unit}} of the page's text."""
    found = {}
    for block in re.findall(r"<!-- compared: \w+ -->\n(.*?)<!-- end compared -->", page, re.DOTALL):
        for line in block.splitlines()[2:]:
            what, against, cases, worst, allowed = [cell.strip() for cell in line.strip("|").split(" | ")]
            bound, _, unit = allowed.partition(" ")
            found[what, against] = {"cases": int(cases), "worst": float(worst), "bound": float(bound), "unit": unit}
    return found


def table(entries):
    """The lines of a table, head and all."""
    return HEAD + "".join("| {what} | {against} | {cases} | {worst:.1e} | {bound:.0e} {unit} |\n".format(**entry)
                          for entry in entries)


def write(page, entries):
    """The page with the tables of those groups made anew of which there are entries."""
    for group in sorted({entry["group"] for entry in entries}):
        rows = table([entry for entry in entries if entry["group"] == group])
        page = marked.replaced(page, BEGIN.format(group) + "\n", END, rows)
    return page


def main(compared, page):
    entries = [json.loads(line) for line in compared.read_text().splitlines()]
    text = write(page.read_text(), entries)
    page.write_text(text)
    print(table(entries), end="")


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:]))
