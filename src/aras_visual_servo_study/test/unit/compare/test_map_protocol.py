"""Protocol `map`: every law and feature is mapped or said to be left out, starts, cells, what is promised, the page."""

import math

import numpy as np
import pytest

from aras_visual_servo import expand, known_features, load_scenario, ParameterError, register_feature
from aras_visual_servo.features import base as features
from aras_visual_servo.laws import base as laws
from aras_visual_servo.laws.image import ImageBased
from aras_visual_servo_study.compare.protocols import protocol_named, runner
from aras_visual_servo_study.compare.protocols.base import Case
from aras_visual_servo_study.compare.protocols.convergence import entries, maps, page, sets, starts
from aras_visual_servo_study.sweep.statistics import wilson


def rows_of(count, arrives):
    """A row for each of the starts; arrives: function of distance [m] and angle [rad]."""
    rows = []
    for number, (a, b) in enumerate(starts.halton(count), start=1):
        won = int(arrives(starts.MOST_M * a, starts.MOST_RAD * b))
        rows.append({"id": number, "outcome": "success" if won else "failure", "success": won, "strict": won,
                     "distance0_mm": 1e3 * starts.MOST_M * a, "angle0_deg": math.degrees(starts.MOST_RAD * b),
                     "error_mm": 1.0, "angle_deg": 0.1, "trace_hash": f"t{number}", "reason": "", "detail": ""})
    return rows


def test_every_law_is_mapped_and_every_feature_is_mapped_or_said_to_be_left_out():
    rows, left_out = sets.plan()
    assert {row.name.partition(f"_{row.set.name}")[0].split("_")[0] for row in rows} == set(laws.known_laws())
    assert len({row.name for row in rows}) == len(rows)
    used = {name for one in sets.SETS for name in expand(one.features)}
    said = dict(left_out)
    for name in known_features():
        assert name in said or name in used or f"{name[:-1]}1" in used, name
    assert set(sets.STANDS_FOR) - used <= set(said) and all(said.values())


def test_each_row_has_a_scenario_that_its_law_takes():
    for row in sets.plan()[0]:
        servo = row.scenario.servo
        made_for = laws.works_on(servo["law"])
        assert made_for is None or tuple(made_for) == expand(row.set.features)
        assert set(servo["gains_per_s"]) == set(expand(row.set.features)), row.name


def test_a_new_law_appears_by_itself_and_a_new_feature_is_listed_as_left_out(monkeypatch):
    monkeypatch.setattr(laws.LAWS, "_plugins", dict(laws.LAWS))
    monkeypatch.setattr(features.FEATURES, "_plugins", dict(features.FEATURES))

    @laws.register_law("mine")
    class Mine(ImageBased):
        pass

    @register_feature("elongation")
    class Elongation(features.Feature):
        pass

    rows, left_out = sets.plan()
    assert "mine_points" in [row.name for row in rows]
    assert "sets.py" in dict(left_out)["elongation"]


def test_starts_cover_distance_and_angle_evenly_and_see_the_whole_target():
    scenario = load_scenario(sets.SCENARIO)
    planned = starts.planned(scenario, 36)
    assert planned[:5] == starts.planned(scenario, 5) and [start.id for start in planned] == list(range(1, 37))
    offsets = np.array([list(start.offset.values()) for start in planned])
    place = np.stack([np.linalg.norm(offsets[:, :3], axis=1) / starts.MOST_M,
                      np.linalg.norm(offsets[:, 3:], axis=1) / starts.MOST_RAD])
    np.testing.assert_allclose(place.T, starts.halton(36), atol=1e-9)
    runs, _, _ = np.histogram2d(*place, bins=3, range=[(0.0, 1.0)] * 2)
    assert np.abs(runs - 4).max() <= 1
    outline = starts._rectangle(scenario)
    kinematics = scenario.kinematics(calibrated=False)
    assert all(outline.border_px(kinematics.pose(kinematics.vector(start.joints))) >= 0.0 for start in planned)
    with pytest.raises(ParameterError, match="starts: found 251, allowed 1 to 250"):
        protocol_named("map").cases(None, 251)
    with pytest.raises(ParameterError, match="--board: found a.png"):
        protocol_named("map").check_own({"board": "a.png"})


def test_cells_count_the_runs_and_only_a_box_in_which_all_arrive_is_promised():
    rows = rows_of(216, lambda distance_m, angle_rad: distance_m < 0.2 and angle_rad < 0.5 * math.pi)
    found = entries.map_of(rows)
    assert found.runs.shape == (6, 6) and found.runs.sum() == 216 and abs(found.runs - 6).max() <= 2
    assert (found.won[:4, :3] == found.runs[:4, :3]).all() and not found.won[4:].any() and not found.won[:, 3:].any()
    assert found.interval(0, 0) == wilson(int(found.won[0, 0]), int(found.runs[0, 0]))
    promised = entries.certificate(found)
    assert (promised.distance_m, promised.angle_rad) == pytest.approx((0.2, 0.5 * math.pi))
    assert promised.runs == found.runs[:4, :3].sum() and promised.least == wilson(promised.runs, promised.runs)[0]
    assert promised.words() == f"200 mm, 90 deg: {promised.runs} of {promised.runs}, > {100 * promised.least:.0f} %"
    rows[0]["success"] = 0 if rows[0]["success"] else 1
    assert entries.certificate(entries.map_of(rows)) != promised
    assert entries.certificate(entries.map_of(rows_of(24, lambda *_: False))).words() == ""


def test_the_page_holds_every_map_with_its_intervals_and_is_the_same_for_the_same_runs(tmp_path):
    def case(law, label):
        return Case(f"{law}_{label}", None, [], {"law": law, "features": label})

    results = [(case("ibvs", "six points"), rows_of(54, lambda distance_m, _: distance_m < 0.1)),
               (case("pbvs", "a tag"), rows_of(54, lambda *_: True)),
               (case("ibvs", "moments, tilt by sx, sy"), rows_of(54, lambda *_: True))]
    texts = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        paths = page.save(results, [("elongation", "no set has it")], tmp_path / name)
        texts.append([path.read_bytes() for path in paths])
    assert [path.name for path in paths] == ["map.html", "map_areas.png", "map_points.png", "map.md"]
    assert texts[0] == texts[1]
    html, areas, points, table = texts[0]
    assert areas != points
    html = html.decode()
    assert html.count("<svg viewBox=") == 3 and html.count("<rect ") == 3 * 9 and "http" not in html
    assert "elongation: no set has it" in html and "300 mm, 180 deg: 54 of 54, &gt; 93 %" in html
    assert "100 to 200 mm, 60 to 120 deg: 0 of 6, 0 to 39 %" in html
    won = sum(row["success"] for row in results[0][1])
    low, high = (100 * end for end in wilson(won, 54))
    assert f"| six points | {100 * won / 54:.0f} ({low:.0f} to {high:.0f}) |  |" in table.decode()


def test_each_map_stands_once_in_one_picture_and_no_line_is_too_long():
    empty = entries.map_of(rows_of(6, lambda *_: True))
    made = [entries.Entry(row.law, row.set.label, 6, 6, 6, empty, entries.certificate(empty), "")
            for row in sets.plan()[0]]
    drawn = []
    for picture in maps.PICTURES:
        lines = maps.lines_of(maps.shown_in(made, picture))
        for line in lines:
            columns = [block.column + k for block in line for k in range(len(block.maps))]
            assert columns == list(range(len(columns))) and len(columns) <= maps.COLUMNS
        areas = [one.of_area for one in sets.SETS for line in lines for block in line if one.label == block.label]
        assert set(areas) == {picture == "areas"}
        drawn += [(one.law, block.label) for line in lines for block in line for one in block.maps]
        assert len(lines) < len({label for _, label in drawn})
    assert sorted(drawn) == sorted((one.law, one.features) for one in made)


def test_the_hash_of_a_table_is_that_of_all_its_runs():
    protocol = protocol_named("map")
    case = Case("x", None, [], {"law": "ibvs", "features": "six points"})
    rows = rows_of(12, lambda *_: True)
    whole = runner.total(runner.table(protocol, [(case, rows)]))
    assert whole == runner.total(runner.table(protocol, [(case, list(rows))])) and len(whole) == 64
    assert whole != runner.total(runner.table(protocol, [(case, [dict(rows[0], trace_hash="other"), *rows[1:]])]))
    other = Case("y", None, [], {"law": "pbvs", "features": "six points"})
    assert whole != runner.total(runner.table(protocol, [(other, rows)]))
