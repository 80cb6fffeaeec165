"""How the experiment node ends a run in lockstep: at one tick, whatever comes late."""
from types import SimpleNamespace

import pytest
from genpy import Time

from aras_visual_servo_controller.nodes import experiment
from aras_visual_servo_controller.nodes.experiment import CLOSING_S, ExperimentNode

DONE_NS, PERIOD_NS = 900_000_000, 1_000_000
END_NS = DONE_NS + round(CLOSING_S * 1e9)


def status(stamp_ns):
    """A paused SimStatus."""
    return SimpleNamespace(header=SimpleNamespace(stamp=Time(0, stamp_ns)), paused=True)


def ending(now_ns, told_ns):
    """(node, steps asked for): a node whose paused simulator stands at now_ns and was last heard of at told_ns."""
    node, asked = object.__new__(ExperimentNode), []

    def step(steps):
        asked.append(steps)
        stamp_ns = now_ns + sum(asked) * PERIOD_NS
        if steps:
            node._status = status(stamp_ns)
        return SimpleNamespace(stamp=Time(0, stamp_ns))

    node._step, node._done_ns, node._status = step, DONE_NS, status(told_ns)
    node._scenario = SimpleNamespace(sim={"period_s": PERIOD_NS * 1e-9})
    return node, asked


@pytest.mark.parametrize("told_ns", [0, DONE_NS, 1_500_000_000])
def test_a_run_ends_at_its_tick_also_where_the_last_status_is_of_before_the_pause(told_ns):
    node, asked = ending(1_500_000_000, told_ns)
    node._close_run()
    assert sum(asked) * PERIOD_NS == END_NS - 1_500_000_000


@pytest.mark.parametrize("now_ns, warnings", [(END_NS, 0), (END_NS + PERIOD_NS, 1)])
def test_a_pause_that_came_too_late_is_told_and_nothing_is_stepped(monkeypatch, now_ns, warnings):
    told = []
    monkeypatch.setattr(experiment.rospy, "logwarn", lambda *words: told.append(words))
    node, asked = ending(now_ns, now_ns)
    node._close_run()
    assert sum(asked) == 0 and len(told) == warnings


@pytest.mark.parametrize("done_ns, told_ns, answered", [
    (None, DONE_NS, False), (DONE_NS, 0, False), (DONE_NS, DONE_NS, False), (DONE_NS, DONE_NS + PERIOD_NS, True)])
def test_the_last_image_is_answered_once_time_has_gone_on_behind_it(done_ns, told_ns, answered):
    node, _ = ending(told_ns, told_ns)
    node._done_ns = done_ns
    assert node._answered() is answered
