"""A law that is written in the page: errors have their line, it acts from the next servo on, no text ends the run."""

import argparse
import time

import pytest

from aras_visual_servo import load_scenario, ParameterError, Status
from aras_visual_servo_study.cli.live import VERBS
from aras_visual_servo_study.live import messages as ask, runner as running
from aras_visual_servo_study.live.editor import EXAMPLE
from aras_visual_servo_study.live.run import LiveRun
from aras_visual_servo_study.live.runner import Runner
from aras_visual_servo_study.live.server import Server

WHOLE_NS = 10**12
LIMIT_S = 60.0
TWIST = "    def _twist(self, look, s, e):\n"
#: Line of the first statement of `_twist` in EXAMPLE.
FIRST = 1 + EXAMPLE[:EXAMPLE.index(TWIST) + len(TWIST)].count("\n")


def saying(code, name="mine"):
    """The example with these lines at the beginning of `_twist`."""
    text = EXAMPLE.replace('"mine"', f'"{name}"')
    return text.replace(TWIST, TWIST + "".join(f"        {line}\n" for line in code.splitlines()))


@pytest.fixture
def run():
    return LiveRun(load_scenario("experiment_1"), edit=True)


def until(run, wanted, most=400):
    for _ in range(most):
        run.advance(WHOLE_NS)
        if wanted(run):
            return
    raise AssertionError(f"not within {most} images: {run.state()}")


def servoing(run):
    return run.phase == "servo"


def ended(run):
    return run.loop.sequence.done


def test_the_example_servoes_and_stands_in_the_file_that_is_saved(run):
    assert run.about()["editor"] == {"text": EXAMPLE}
    assert run.do(ask.WriteLaw(EXAMPLE)) == {"law": "mine"}
    run.do(ask.Start())
    until(run, ended)
    assert run.record.status == Status.CONVERGED
    assert run.state()["editor"] == {"law": "mine", "waits": False, "faults": [], "again": ""}
    assert run.scenario.servo["law"] == "mine" and "mine" in run.about()["choices"]["servo.law"]
    saved = run.do(ask.Save())["yaml"]
    assert saved.startswith("#") and "mine.py" in saved and "law: mine" in saved


def test_without_the_option_there_is_no_editor():
    run = LiveRun(load_scenario("experiment_1"))
    with pytest.raises(ParameterError, match="--edit"):
        run.do(ask.WriteLaw(EXAMPLE))
    assert run.about()["editor"] is None and "editor" not in run.state() and run.scenario.servo["law"] != "mine"


@pytest.mark.parametrize("host", ["0.0.0.0", "192.0.2.1", "example.org", "::", ""])
def test_the_option_is_refused_where_others_reach_the_page(run, host):
    with pytest.raises(ParameterError, match="--edit allowed 127.0.0.1"):
        Server(Runner(run), run.scenario.urdf_xml()).listen(host, 0)


def test_the_command_refuses_it_before_anything_runs():
    parser = argparse.ArgumentParser()
    VERBS["live"].options(parser)
    with pytest.raises(ParameterError, match="^host: found 0.0.0.0"):
        VERBS["live"].work(parser.parse_args(["experiment_1", "--edit", "--host", "0.0.0.0", "--port", "0"]))


@pytest.mark.parametrize("text, said", [
    ("import numpy\n\ndef f(:\n", "^law.py:3: SyntaxError"),
    ("\nimport nothing_here\n", "^law.py:2: ModuleNotFoundError"),
    ("a = 1\nb = a / 0\n", "^law.py:2: ZeroDivisionError"), ("import sys\nsys.exit(3)\n", "^law.py:2: SystemExit: 3"),
    ("x = '\0'", "ValueError|SyntaxError"), ("x = 1\n", "found laws: none"),
    (EXAMPLE + EXAMPLE.replace("mine", "second"), "found laws: mine, second"),
    (EXAMPLE.replace('"mine"', '"ibvs"'), "found the name ibvs, which another law has"),
    (EXAMPLE.replace("(Law)", ""), "found law mine, which is no class derived from Law"),
    (EXAMPLE.replace("None, True", '("x1", "y1"), True'), "servo.features: found xn, yn, an, alpha, allowed .*x1, y1"),
    (EXAMPLE.replace(TWIST, "    def _prepare(self):\n        1 / 0\n\n" + TWIST), "^law.py:10: ZeroDivisionError")])
def test_a_text_that_cannot_be_used_is_refused_with_its_line_and_changes_nothing(run, text, said):
    run.do(ask.Start())
    until(run, servoing)
    before, servo, laws = run.scenario, run.servo, run.about()["choices"]["servo.law"]
    with pytest.raises(ParameterError, match=said):
        run.do(ask.WriteLaw(text))
    run.advance(WHOLE_NS)
    assert run.scenario is before and run.servo is servo and servoing(run)
    assert run.about()["choices"]["servo.law"] == laws and run.about()["editor"] == {"text": EXAMPLE}


def test_a_law_acts_from_the_next_servo_on(run):
    run.do(ask.Start())
    until(run, servoing)
    run.do(ask.WriteLaw(saying("raise KeyError('used')")))
    run.do(ask.Set({"servo.gains_per_s.xn": 2.0}))  # makes the law anew, still that of before
    assert run.state()["editor"]["waits"] and run.servo.config.law == "decoupled"
    until(run, ended)
    assert run.record.status == Status.CONVERGED and run.servo.config.law == "mine"
    run.do(ask.WriteLaw(EXAMPLE))
    assert run.do(ask.Again()) == {} and run.servo.config.law == "mine" and not run.state()["editor"]["waits"]
    until(run, ended)
    assert run.record.status == Status.CONVERGED


@pytest.mark.parametrize("code, line", [
    ("self.count = getattr(self, 'count', 0) + 1\nif self.count > 5:\n    raise KeyError('late')", FIRST + 2),
    ("raise SystemExit", FIRST), ("return np.zeros(5)", FIRST - 1), ("return np.full(6, np.nan)", FIRST - 1)])
def test_a_law_that_fails_ends_its_servo_and_the_former_one_is_used_again(run, code, line):
    run.do(ask.WriteLaw(EXAMPLE))
    run.do(ask.Start())
    until(run, ended)
    run.do(ask.WriteLaw(saying(code)))
    run.do(ask.Again())
    run.advance(WHOLE_NS)
    until(run, ended)
    state = run.state()
    assert state["status"] == "FAULT" and not run.record.q_dot.any()
    fault, = state["editor"]["faults"]
    assert f"law.py:{line}: " in fault
    assert state["editor"]["law"] == "" and state["editor"]["again"].startswith("mine ")  # the text before it
    run.do(ask.Start("taught"))  # the former text, which has the same name
    run.advance(WHOLE_NS)
    until(run, ended)
    assert run.record.status == Status.CONVERGED and run.servo.config.law == "mine"
    run.do(ask.WriteLaw(saying(code, name="other")))
    run.do(ask.Start("taught"))  # it may end with its first image
    run.advance(WHOLE_NS)
    until(run, ended)
    assert run.state()["status"] == "FAULT" and run.servo.config.law == "mine"


def test_code_that_does_not_come_back_is_interrupted(run, monkeypatch):
    monkeypatch.setattr(running, "HUNG_S", 0.3)
    run.do(ask.WriteLaw(saying("while True:\n    pass")))
    runner = Runner(run, 0.0, None)
    runner.watched = True
    runner.start()
    try:
        runner.submit(ask.Start()).result(LIMIT_S)
        end_s = time.monotonic() + LIMIT_S
        while runner.sample is None or runner.sample.state["status"] != "FAULT":
            assert time.monotonic() < end_s
            runner.interrupt_hung()
            time.sleep(0.02)
        fault, = runner.sample.state["editor"]["faults"]
        assert f"law.py:{FIRST}: " in fault or f"law.py:{FIRST + 1}: " in fault
        # The servo that ended with its first image is told with the law that it had.
        begun, ended_with = [message for _, message in runner.servos]
        assert begun["values"]["servo"]["law"] == ended_with["after"]["servo"]["law"] == "mine"
        assert runner.submit(ask.Stop()).result(LIMIT_S) == {} and runner.about["values"]["servo"]["law"] == "decoupled"
    finally:
        runner.close()
