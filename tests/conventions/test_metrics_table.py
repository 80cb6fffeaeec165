"""The metrics that docs/sweeps.md lists are those that sweeps compute, with their thresholds and sources."""
import pathlib
import re

from aras_visual_servo_study.sweep.metrics import known_metrics

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"


def test_docs_list_every_metric_with_its_threshold_and_source():
    rows = re.findall(r"^\| `(\w+)` \| (below .*?) \| (.*?) \|$", (DOCS / "sweeps.md").read_text(), re.MULTILINE)
    found = {name: (threshold, source) for name, threshold, source in rows}
    assert set(found) == {metric.name for metric in known_metrics()}
    for metric in known_metrics():
        threshold, source = found[metric.name]
        assert threshold == metric.threshold and source.startswith(metric.source)
