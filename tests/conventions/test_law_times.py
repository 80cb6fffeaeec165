"""The table of times in docs/features_and_laws.md has the rows that law_times.py measures."""
import importlib.util
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "src/aras_visual_servo_study/bench/law_times.py"


def test_the_table_has_the_rows_that_are_measured():
    spec = importlib.util.spec_from_file_location("law_times", PROGRAM)
    law_times = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(law_times)
    page = (ROOT / "docs" / "features_and_laws.md").read_text()
    rows = page.partition(law_times.BEGIN)[2].partition(law_times.END)[0].splitlines()[3:]
    stated = [re.sub(r" [0-9.]+ \| [0-9.]+ \| [0-9.]+ \|$", "", row) for row in rows]
    assert stated == [law_times.label(*row) for row in law_times.ROWS], f"{PROGRAM.name} --write renews the table"
