"""docs/tutorial.ipynb, executed cell by cell by Debian's nbconvert."""
import pathlib
import re

import nbformat
from nbconvert.preprocessors import ExecutePreprocessor

import aras_visual_servo as avs

NOTEBOOK = pathlib.Path(__file__).resolve().parents[2] / "docs" / "tutorial.ipynb"
#: Instead of 200 in the notebook: the way is the same.
STARTS = 6
LIMIT_S = 900


def text_of(cell):
    """What a code cell printed."""
    return "".join(output.get("text", "") for output in cell["outputs"])


def test_the_notebook_runs_and_shows_what_the_tutorial_says(tmp_path):
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    assert all(not cell.outputs for cell in notebook.cells if cell.cell_type == "code"), "store it without outputs"
    for cell in notebook.cells:
        cell.source = cell.source.replace("STARTS = 200", f"STARTS = {STARTS}")
    ExecutePreprocessor(timeout=LIMIT_S).preprocess(notebook, {"metadata": {"path": str(tmp_path)}})
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    said = "\n".join(map(text_of, code))
    assert avs.run(avs.load_scenario("experiment_1")).run_hash in said
    for asked, found in re.findall(r"gain (\d) /s: the slope is ([\d.]+) /s", said):
        assert abs(float(found) - float(asked)) < 0.05 * float(asked)
    assert "2.87 s with ours, 3.30 s with mine" in said and re.search(r"^[4-6] pairs; median", said, re.MULTILINE)
    pictures = [output for cell in code for output in cell["outputs"] if "image/png" in output.get("data", {})]
    assert len(pictures) == 3 and not re.search("Error|Warning", said)
