"""Protocol `latency`: delays that cover the square evenly, starts that do not depend on their number, lines and map."""

import numpy as np
import pytest

from aras_visual_servo_study.compare.protocols import delay_map, latency, protocol_named, runner
from aras_visual_servo.ground.errors import ParameterError

AXES = (f"p_{latency.IMAGE}", f"p_{latency.COMMAND}")


def rows_of(count, most_s=0.3):
    """A row for each pair of delays; those that are together shorter than most_s succeed."""
    return [{"id": i + 1, "outcome": "success", "success": int(a + b < most_s), "trace_hash": f"t{i}", "error_mm": 1.0,
             "angle_deg": 0.1, AXES[0]: a, AXES[1]: b} for i, (a, b) in enumerate(latency.delays(count))]


def test_delays_cover_the_square_evenly_however_few_there_are():
    many = latency.delays(2000)
    np.testing.assert_array_equal(latency.delays(100), many[:100])
    assert many.min() > 0.0 and many.max() < latency.MOST_S and len(np.unique(many, axis=0)) == 2000
    for count in (100, 2000):
        runs, _, _ = np.histogram2d(*many[:count].T, bins=5, range=[(0.0, latency.MOST_S)] * 2)
        assert np.abs(runs - count / 25).max() <= 4  # of a random 2000, one cell would have 25 more or less
    with pytest.raises(ParameterError, match="starts: found 10001, allowed 1 to 10000"):
        protocol_named("latency").cases(None, 10_001)


def test_the_first_runs_are_the_same_however_many_there_are_and_each_can_be_tried():
    few, more = (protocol_named("latency").cases(None, count) for count in (3, 12))
    for one, other in zip(few, more):
        assert one.name == other.name and one.starts == other.starts[:3]
        assert [start.id for start in other.starts] == list(range(1, 13))
        assert not any(start.refusal for start in other.starts)
        found = [[start.parameters[latency.IMAGE], start.parameters[latency.COMMAND]] for start in other.starts]
        np.testing.assert_array_equal(found, latency.delays(12))


def test_the_table_has_a_line_for_each_band_of_the_sum_of_delays():
    protocol, rows = protocol_named("latency"), rows_of(400)
    case = protocol.cases(None, 1)[0]
    head, *lines = runner.table(protocol, [(case, rows)])
    assert head[:2] == ["case", "sum of delays"] and [line[1] for line in lines] == [
        "0.0 to 0.2 s", "0.2 to 0.4 s", "0.4 to 0.6 s", "0.6 to 0.8 s", "0.8 to 1.0 s"]
    assert sum(int(line[2]) for line in lines) == 400
    rates = [dict(zip(head, line))["success"] for line in lines]
    assert rates[0] == "100.0 %" and 0.0 < float(rates[1].split()[0]) < 100.0 and rates[2:] == ["0.0 %"] * 3


def test_the_map_shows_where_runs_succeed_and_is_the_same_for_the_same_runs(tmp_path):
    rate, edges = delay_map.cells(rows_of(2000), AXES, latency.MOST_S)
    assert edges[-1] == latency.MOST_S and rate[0, 0] == 1.0 and rate[-1, -1] == 0.0
    middles = 0.5 * (edges[1:] + edges[:-1])
    total = np.add.outer(middles, middles)
    width = edges[1]
    assert (rate[total < 0.3 - width] == 1.0).all() and (rate[total > 0.3 + width] == 0.0).all()
    case = protocol_named("latency").cases(None, 1)[0]
    paths = [protocol_named("latency").save_pictures([(case, rows_of(60))], tmp_path / name)
             for name in ("a", "b") if not (tmp_path / name).mkdir()]
    assert [path.name for path in paths[0]] == ["moments_arm_map.png"]
    assert paths[0][0].read_bytes() == paths[1][0].read_bytes()
    assert (tmp_path / "a" / "moments_arm_map.pdf").exists()


def test_the_border_is_that_of_a_late_integrator():
    """x' = -k x(t - T), sampled finely: it comes to rest below the border and not above."""
    def ends(delay_s, gain=3.0, dt=0.001, rate_hz=30.0):
        x = [1.0]
        u, hold = 0.0, round(1.0 / rate_hz / dt)
        late = round(delay_s / dt)
        for step in range(40_000):
            if step % hold == 0:
                u = -gain * (x[step - late] if step >= late else 0.0)
            x.append(x[-1] + dt * u)
        return max(abs(value) for value in x[-3000:])

    border = delay_map.border_s(3.0, 30.0)
    assert ends(0.95 * border) < 0.1 and ends(1.05 * border) > 1.0


def test_late_images_and_commands_reach_the_simulator_and_a_long_delay_costs_the_run():
    pytest.importorskip("aras_visual_servo_sim")
    from aras_visual_servo_study.sweep.plan import Start
    from aras_visual_servo_study.sweep.run import SweepRunner
    case = protocol_named("latency").cases(None, 1)[0]
    bench, start = SweepRunner(case.scenario), case.starts[0]
    rows = []
    for image_s, command_s in ((0.0, 0.0), (0.05, 0.05), (0.0, 0.1), (0.48, 0.48)):
        late = {latency.IMAGE: image_s, latency.COMMAND: command_s}
        rows.append(bench.run(Start(1, start.joints, start.offset, late))[0])
    assert [row["outcome"] for row in rows] == ["success", "success", "success", "failure"], rows
    assert len({row["trace_hash"] for row in rows}) == 4
