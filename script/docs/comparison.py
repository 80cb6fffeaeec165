"""The tables of docs/comparison.md: a cell is the final error [mm] or how the run ended, and the detour [mm].

script/gallery makes them again; tests/closed_loop/test_comparison_page.py holds some of their cells.
"""
#: Table -> the scenario that it was run on; None: that of the comparison itself.
TABLES = {"free_camera": "free_camera", "arm": None}
BEGIN, END = "<!-- comparison: {} -->\n", "<!-- end comparison -->"
#: Ends of a run that the table calls otherwise.
SHORT = {"converged elsewhere": "elsewhere"}


def cell(row):
    """The cell of a run, a row of `run_comparison`."""
    from aras_visual_servo_controller.compare.laws_report import arrived, verdict

    ended = f"{row['error_mm']:.2f}" if arrived(row) else f"**{SHORT.get(verdict(row), verdict(row))}**"
    return f"{ended}; {row['detour_mm']:.0f}"


def read(page, table):
    """{(law, task): cell} of a table of the page."""
    lines = page.partition(BEGIN.format(table))[2].partition(END)[0].splitlines()
    titles = [title.strip().replace(" ", "_") for title in lines[0].strip("| ").split("|")][1:]
    found = {}
    for line in lines[2:]:
        law, *cells = [text.strip() for text in line.strip("| ").split("|")]
        found.update({(law.strip("`"), task): text for task, text in zip(titles, cells)})
    return found


def write(page, table, results):
    """The page with a table made anew of what `run_comparison` returned."""
    tasks, laws = ([*dict.fromkeys(result[k] for result in results)] for k in (0, 1))
    cells = {(law, task): cell(row) for task, law, row, _ in results}
    lines = [f"| law | {' | '.join(task.replace('_', ' ') for task in tasks)} |", "|---" * (len(tasks) + 1) + "|"]
    lines += [f"| `{law}` | {' | '.join(cells[law, task] for task in tasks)} |" for law in laws]
    before, found, rest = page.partition(BEGIN.format(table))
    _, ended, after = rest.partition(END)
    if not (found and ended):
        raise SystemExit(f"comparison: found no '{BEGIN.format(table).strip()}' ... '{END}' in the page")
    return "".join([before, found, "\n".join(lines), "\n", END, after])
