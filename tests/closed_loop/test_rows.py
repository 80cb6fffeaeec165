"""The check of a feature's row of the interaction matrix against rendered images."""
import pytest
import yaml

from aras_visual_servo import load_scenario
from aras_visual_servo.cli.main import main
from aras_visual_servo.runs.rows import check_rows

PLUGIN = '''
from aras_visual_servo import Feature, register_feature

@register_feature("{name}")
class Mine(Feature):
    order = 2

    def value(self, view):
        return view.features.an ** 2

    def row(self, view):
        row = 2.0 * view.features.an * view.L_normalised()[2]
        row[{column}] *= {factor}
        return row
'''


@pytest.mark.parametrize("name, features, most", [
    ("experiment_1", ("xn", "yn", "an", "alpha"), 0.005), ("six_dof_points", ("x1", "y1", "x4", "y4"), 0.005),
    ("ur5e", ("xn", "yn", "an", "sx", "sy", "alpha"), 0.04)])
def test_rows_of_the_features_are_the_differences(name, features, most):
    found = check_rows(load_scenario(name), views=2)
    assert set(features) <= set(found.feature_names) and found.rows.shape == found.differences.shape
    assert max(found.deviation.values()) < most and not any(found.columns(each, 0.05) for each in features)


@pytest.mark.parametrize("name, factor, code", [("right", 1.0, 0), ("turned", -1.0, 1)])
def test_a_wrong_column_of_a_feature_of_ones_own_is_named(tmp_path, capsys, name, factor, code):
    (tmp_path / f"{name}.py").write_text(PLUGIN.format(name=name, column=2, factor=factor))
    servo = {"plugins": [name], "features": ["xn", "yn", name, "alpha"], "law": "ibvs", "gains_per_s": {name: 1.0},
             "thresholds": {name: 0.01}}
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump({"name": "mine", "extends": "experiment_1", "servo": servo}))
    assert main(["scenario", "rows", str(tmp_path / "mine.yaml")]) == code
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [line[0] for line in lines] == ["xn", "yn", name, *["vz:"] * code, "alpha"]
    if code:
        row, difference = float(lines[3][2].rstrip(",")), float(lines[3][4])
        assert row == pytest.approx(-difference, rel=0.01)


def test_what_has_no_rows_to_check_is_refused(capsys):
    assert main(["scenario", "rows", "six_dof_photometric"]) == 2
    assert main(["scenario", "rows", "experiment_1", "--views", "0"]) == 2
    assert "views" in capsys.readouterr().err
