"""The tables of docs/comparison.md: a cell is the final error [mm] or how the run ended, and the detour [mm].

script/gallery makes them again; tests/closed_loop/test_figures_of_runs.py holds some of their cells.
"""
import marked

#: Table -> the scenario that it was run on; None: that of the comparison itself.
TABLES = {"free_camera": "free_camera", "arm": None}
BEGIN, END = "<!-- comparison: {} -->\n", "<!-- end comparison -->"
#: Ends of a run that the table calls otherwise.
SHORT = {"converged elsewhere": "elsewhere"}


def cell(row):
    """The cell of a run, a row of `run_comparison`."""
    from aras_visual_servo_study.compare.laws_report import arrived, verdict

    ended = f"{row['error_mm']:.2f}" if arrived(row) else f"**{SHORT.get(verdict(row), verdict(row))}**"
    return f"{ended}; {row['detour_mm']:.0f}"


def read(page, table):
    """{(law, task): cell} of a table of the page."""
    lines = marked.parts(page, BEGIN.format(table), END)[1].splitlines()
    titles = [title.strip().replace(" ", "_") for title in lines[0].strip("| ").split("|")][1:]
    found = {}
    for line in lines[2:]:
        law, *cells = [text.strip() for text in line.strip("| ").split("|")]
        found.update({(law.strip("`"), task): text for task, text in zip(titles, cells)})
    return found


def numbers(cell):
    """(final error [mm] or None, how the run ended or "", detour [mm]) of a cell."""
    ended, detour = cell.split("; ")
    word = ended.strip("*") if ended.startswith("*") else ""
    return (None if word else float(ended)), word, float(detour)


def write(page, table, results):
    """The page with a table made anew of what `run_comparison` returned."""
    tasks, laws = ([*dict.fromkeys(result[k] for result in results)] for k in (0, 1))
    cells = {(law, task): cell(row) for task, law, row, _ in results}
    lines = [f"| law | {' | '.join(task.replace('_', ' ') for task in tasks)} |", "|---" * (len(tasks) + 1) + "|"]
    lines += [f"| `{law}` | {' | '.join(cells[law, task] for task in tasks)} |" for law in laws]
    return marked.replaced(page, BEGIN.format(table), END, "\n".join(lines) + "\n")
