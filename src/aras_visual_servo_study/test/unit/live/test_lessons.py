"""Lessons: each can be set and tried, its check follows the run, and a folder of one's own is read and checked."""

import pytest

from aras_visual_servo import load_scenario, ParameterError, Status
from aras_visual_servo_study.live import messages as ask
from aras_visual_servo_study.live.lesson import LESSONS, lessons, load_lessons
from aras_visual_servo_study.live.page_run import PageRun
from aras_visual_servo_study.live.run import LiveRun

WHOLE_NS = 10**12
MOST_IMAGES = 2000
MINE = """
from aras_visual_servo_study.live.lesson import Lesson, register_lesson

@register_lesson("mine_{name}")
class Mine(Lesson):
    order, title, scene, question = 90, "Mine", "It is here.", "Will it work?"
    changes = {{"a": {{"servo.time_limit_s": 0.5}}, "b": {{"servo.{key}": 5.0}}}}
    answers = {{"yes": "It will.", "no": "It will not."}}

    def finding(self, first, run):
        return {finding}
"""


@pytest.fixture
def known():
    before = dict(LESSONS)
    yield
    for name in set(LESSONS) - set(before):
        del LESSONS[name]


def told(run, request):
    """What the lesson says when the run that a request begins has ended."""
    run.do(request)
    for _ in range(MOST_IMAGES):
        if not run.state()["lesson"]["running"]:
            return run.state()["lesson"]
        run.advance(WHOLE_NS)
    raise AssertionError("the run of the lesson did not end")


def test_there_are_eight_lessons_whose_scenes_are_allowed():
    assert len(lessons()) == 8
    for lesson in lessons():
        for change in (None, *lesson.changes):
            lesson.setting(change)


# What is known beforehand: the exact exponential law, features in proportion to the depth, joints that take time.
@pytest.mark.parametrize("name, change, right", [
    ("exponential_decay", "gain 6 per second", "inverse"),
    ("gain_30", "gain 30 per second", "overshoots"),
    ("wrong_depth", "told twice the depth, 1.18 m", "rate"),
    ("singularity", "J3 bent by 0.02 rad", "faster"),
    ("camera_retreat", "turn by 60 deg", "away"),
    ("moments_and_points", "moments xn, yn, an, sx, sy, alpha", "straight")])
def test_the_answer_is_checked_against_the_run(name, change, right):
    run, lesson = LiveRun(load_scenario("experiment_1")), LESSONS[name]
    assert told(run, ask.SetLesson(name))["ready"]
    for answer in list(dict.fromkeys([right, next(iter(set(lesson.answers) - {right}))])):
        state = told(run, ask.TryLesson(change, answer))
        assert state["found"] == lesson.answers[right] and state["right"] == (answer == right)
    run.do(ask.SetLesson())
    assert run.scenario.name == "experiment_1" and "lesson" not in run.state()


def test_a_scene_that_is_changed_by_hand_is_judged_as_it_ran():
    run = LiveRun(load_scenario("experiment_1"))
    assert told(run, ask.SetLesson("exponential_decay"))["ready"]
    run.do(ask.TryLesson("gain 6 per second", "inverse"))
    gains = dict.fromkeys(("xn", "yn", "an", "alpha"), 2.0)
    run.do(ask.Set({"servo.gains_per_s": gains}))
    while run.state()["lesson"]["running"]:
        run.advance(WHOLE_NS)
    assert run.record.status == Status.CONVERGED
    assert run.state()["lesson"]["right"] is False  # it decayed at 2 per second, though the scene asked for 6


def test_what_is_not_the_lessons_is_refused_and_a_stop_is_no_answer():
    run = LiveRun(load_scenario("experiment_1"))
    with pytest.raises(ParameterError, match="latency"):
        run.do(ask.SetLesson("latncy"))
    with pytest.raises(ParameterError):
        run.do(ask.TryLesson("delay 0.1 s", "smooth"))
    run.do(ask.SetLesson("latency"))
    run.advance(WHOLE_NS)
    run.do(ask.Stop())
    run.advance(WHOLE_NS)
    state = run.state()["lesson"]
    assert not state["running"] and not state["ready"]
    with pytest.raises(ParameterError) as error:
        run.do(ask.TryLesson("delay 9 s", "maybe"))
    assert len(error.value.faults) == 3


def test_a_reset_breaks_a_lesson_off_and_a_run_over_ros_gives_none():
    run = LiveRun(load_scenario("experiment_1"))
    run.do(ask.SetLesson("latency"))
    run.advance(WHOLE_NS)
    run.do(ask.Reset())
    assert not run.state()["lesson"]["running"] and not run.state()["lesson"]["ready"]
    for request in (ask.SetLesson("latency"), ask.TryLesson("delay 0.1 s", "smooth")):
        with pytest.raises(ParameterError):
            PageRun.do_lesson(run, request)
    assert PageRun.lessons(run) == [] and PageRun.do_try_lesson is PageRun.do_lesson


def test_a_folder_of_ones_own_is_read_and_all_its_faults_are_told(tmp_path, known):
    good, bad = tmp_path / "good", tmp_path / "bad"
    for folder, key, finding in ((good, "time_limit_s", "'maybe', ''"), (bad, "no_such_key", "'yes', ''")):
        folder.mkdir()
        (folder / f"mine_{folder.name}.py").write_text(MINE.format(name=folder.name, key=key, finding=finding))
    load_lessons(good)
    run = LiveRun(load_scenario("experiment_1"))
    assert run.about()["lessons"][-1]["name"] == "mine_good"
    assert told(run, ask.SetLesson("mine_good"))["ready"]
    state = told(run, ask.TryLesson("a", "yes"))
    assert state["right"] is None and "maybe" in state["text"]
    (bad / "broken_lesson.py").write_text("x = = 1\n")
    with pytest.raises(ParameterError) as error:
        load_lessons(bad)
    text = "\n".join(error.value.faults)
    assert "broken_lesson.py:1" in text and "mine_bad" in text and "no_such_key" in text
    with pytest.raises(ParameterError):
        load_lessons(tmp_path / "none")
