"""A lesson of the live page: a scene, a question, one thing to change, and the check of the answer.

    @register_lesson("my_lesson")
    class MyLesson(Lesson):
        order, title, scenario = 90, "My lesson", "experiment_1"
        scene, question = "What is seen first.", "What will another gain do?"
        changes = {"gain 1": {"servo.gains_per_s": dict.fromkeys(FEATURE_NAMES, 1.0)}, "gain 6": {...}}
        answers = {"slower": "The error falls more slowly.", "faster": "It falls faster."}

        def finding(self, first, run):
            return "slower" if ... else "faster", "What was measured, with its numbers."

A lesson is a file in the package `lessons`, or in a folder of the user's own (`aras-servo live --lessons FOLDER`).
"""

from pathlib import Path
from typing import Any, Callable, ClassVar, Dict, List, Mapping, Optional, Tuple, Type

from aras_visual_servo import (ParameterError, RecordBuilder, Registry, RunRecord, Scenario, ServoRecord, Status,
                               code_place, load_plugins, load_scenario)
from .settings import changed

LEAST = 2  # changes, and answers


class Lesson:
    """Base class of the lessons. A subclass sets the attributes and implements `finding`.

    Attributes:
        name: set by `register_lesson`.  order: place in the list.  title: of the list.  scenario: name or path.
        values: dotted path -> value, what the scene changes in the scenario.
        scene: what the first run shows.  question: what to foretell before one thing is changed.
        changes: label -> values, dotted path -> value; the student chooses one.
        answers: key -> sentence; the student chooses one.
    """

    name: ClassVar[str] = ""
    order: ClassVar[int] = 100
    title: ClassVar[str] = ""
    scenario: ClassVar[str] = "experiment_1"
    values: ClassVar[Mapping[str, Any]] = {}
    scene: ClassVar[str] = ""
    question: ClassVar[str] = ""
    changes: ClassVar[Mapping[str, Mapping[str, Any]]] = {}
    answers: ClassVar[Mapping[str, str]] = {}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Returns the key of the answer that is right, and the sentence with what was measured.

        Args: first: of the scene as it was set.  run: of the scene with the student's change. Both have servoed.
        """
        raise NotImplementedError

    def setting(self, change: Optional[str] = None) -> Scenario:
        """Returns the scenario, with a change or without. Raises ParameterError: a value is not allowed."""
        if change is not None and change not in self.changes:
            raise ParameterError(f"change: found {change}, allowed one of {', '.join(self.changes)}")
        values = {**self.values, **(self.changes[change] if change is not None else {})}
        scenario = load_scenario(self.scenario)
        return changed(scenario, values) if values else scenario

    def about(self) -> Dict[str, Any]:
        """Returns, for JSON, what a page shows of the lesson."""
        return {"name": self.name, "title": self.title, "scene": self.scene, "question": self.question,
                "changes": list(self.changes), "answers": dict(self.answers)}


#: Name -> class of the lesson.
LESSONS: Registry[Type[Lesson]] = Registry("lesson", f"{__package__}.lessons")


def register_lesson(name: str) -> Callable[[Type[Lesson]], Type[Lesson]]:
    """Returns a class decorator that adds a lesson. Raises ParameterError, with all faults: something is missing."""
    def add(lesson: Type[Lesson]) -> Type[Lesson]:
        faults = [f"lesson {name}.{key}: found nothing, allowed a text" for key in ("title", "scene", "question")
                  if not getattr(lesson, key)]
        faults += [f"lesson {name}.{key}: found {len(getattr(lesson, key))}, allowed {LEAST} or more"
                   for key in ("changes", "answers") if len(getattr(lesson, key)) < LEAST]
        if lesson.finding is Lesson.finding:
            faults.append(f"lesson {name}.finding: found nothing, allowed a method (first, run)")
        if faults:
            raise ParameterError(faults)
        return LESSONS.register(name, name=name)(lesson)

    return add


def lessons() -> List[Lesson]:
    """Returns all lessons that are known, by their order."""
    return [lesson() for lesson in sorted(LESSONS.values(), key=lambda lesson: (lesson.order, lesson.name))]


def load_lessons(folder: Path) -> None:
    """Imports every file of a folder, and checks the scenes of the lessons that it registers.

    Raises: ParameterError, with all faults: no folder, no lesson in it, or a lesson with a fault.
    """
    if not folder.is_dir():
        raise ParameterError(f"--lessons: found {folder}, allowed a folder with lessons, one Python file each")
    before = dict(LESSONS)
    files = [str(path.resolve().with_suffix("")) for path in sorted(folder.glob("*.py"))]
    faults: List[str] = list(load_plugins(files))
    added = [lesson() for name, lesson in LESSONS.items() if before.get(name) is not lesson]
    for lesson in added:
        for change in (None, *lesson.changes):
            try:
                lesson.setting(change)
            except ParameterError as error:
                faults += [f"lesson {lesson.name}, {change or 'scene'}: {fault}" for fault in error.faults]
    if not added and not faults:
        faults.append(f"--lessons: found no lesson in {folder}, allowed files that call register_lesson")
    if faults:
        raise ParameterError(faults)


class LessonInHand:
    """Records the runs of a lesson and checks an answer against them.

    Args: before: the scenario to which the page returns after the lesson.
    Attributes: lesson.  before.  first: record of the scene as it was set, None until it has ended.
    """

    def __init__(self, lesson: Lesson, before: Scenario) -> None:
        self.lesson, self.before = lesson, before
        self.first: Optional[RunRecord] = None
        self._builder: Optional[RecordBuilder] = None
        self._change, self._answer = "", ""
        self._told: Dict[str, Any] = {}

    def check(self, change: str, answer: str) -> None:
        """Raises ParameterError, with all faults: the change or the answer is none of the lesson's."""
        faults = [f"try_lesson.{key}: found {found}, allowed one of {', '.join(allowed)}"
                  for key, found, allowed in (("change", change, self.lesson.changes),
                                              ("answer", answer, self.lesson.answers)) if found not in allowed]
        if self.first is None:
            faults.append("try_lesson: found a first run in progress, allowed after its end")
        if faults:
            raise ParameterError(faults)

    def begin(self, builder: RecordBuilder, change: str = "", answer: str = "") -> None:
        """Begins to record a run: that of the scene, or that with a change, for which an answer was foretold."""
        self._builder, self._change, self._answer, self._told = builder, change, answer, {}

    def break_off(self) -> None:
        """Ends what is recorded, because the run begins anew."""
        if self._builder is not None:
            self._end(None, "The run began anew before it had ended. Set the scene again.")

    def take(self, record: ServoRecord, X_WC: Any) -> None:
        """Adds an image of the run. Its last one is checked."""
        builder = self._builder
        if builder is None:
            return
        if record.feature_names != builder.feature_names:
            self._end(None, "The features were changed while it went on. Set the scene again.")
            return
        builder.add_answer(record, X_WC)
        if record.phase != "done":
            return
        run = builder.finish()
        if not len(run.servo_rows) or record.status == Status.STOPPED:
            self._end(None, f"The run ended before it could be checked: {record.status_text}.")
        elif not self._change:
            self.first = run
            self._end(None, "")
        else:
            self._find(run)

    def _find(self, run: RunRecord) -> None:
        assert self.first is not None
        try:
            right, text = self.lesson.finding(self.first, run)
            if right not in self.lesson.answers:
                allowed = ", ".join(self.lesson.answers)
                raise ParameterError(f"finding: found the answer {right}, allowed one of {allowed}")
        except Exception as error:  # a teacher's code may raise anything, and the run goes on without it
            self._end(None, f"The lesson {self.lesson.name} could not check the run: {code_place(error)}{error}")
            return
        self._end(right == self._answer, text, right)

    def _end(self, right: Optional[bool], text: str, answer: str = "") -> None:
        self._builder, self._told = None, {"right": right, "text": text, "found": self.lesson.answers.get(answer, "")}

    def state(self) -> Dict[str, Any]:
        """Returns, for JSON, how the lesson stands.

        name, running: whether a run goes on.  ready: whether the first run has ended.  change, answer: of the student.
        right: of the answer, None if nothing was checked.  text: what was measured.  found: the right answer.
        """
        return {"name": self.lesson.name, "running": self._builder is not None, "ready": self.first is not None,
                "change": self._change, "answer": self._answer, "right": None, "text": "", "found": "", **self._told}
