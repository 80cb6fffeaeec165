"""What a comparison file says (docs/comparison.md)."""

from dataclasses import dataclass
from typing import Dict, Iterator

from aras_visual_servo import CAMERA_AXES, GOAL_AXES, keys_of, setting


@dataclass(frozen=True)
class TaskSettings:
    """One entry of `tasks`: either `offset` or `tilt`."""

    title: str = setting("", help="Name in tables and plots; default: the key.")
    offset: Dict[str, float] = setting(
        {}, unit="m, rad",
        help=f"Start displaced from the goal along and about the goal camera's axes: {', '.join(CAMERA_AXES)}.")
    tilt: Dict[str, float] = setting(
        {}, unit="rad",
        help=f"Start on a sphere about the target: `{GOAL_AXES[0]}` about axis `{GOAL_AXES[1]}` of the image plane.")

    def check(self) -> Iterator[str]:
        """One of the two, by axes that there are."""
        for key, axes in (("offset", CAMERA_AXES), ("tilt", GOAL_AXES)):
            for name in getattr(self, key):
                if name not in axes:
                    yield f"{key}.{name}: found an unknown key, allowed {', '.join(axes)}"
        if bool(self.offset) == bool(self.tilt) or len(self.tilt) not in (0, len(GOAL_AXES)):
            yield f"found {[*self.offset, *self.tilt]}, allowed either offset, or tilt with tilt_rad and about_rad"


@dataclass(frozen=True)
class LawSettings:
    """One entry of `laws`: what it changes in the scenario, key by key."""

    servo: Dict[str, object] = setting({}, help="Keys of the section `servo`.")
    vision: Dict[str, object] = setting({}, help="Keys of the section `vision`.")
    sim: Dict[str, object] = setting({}, help="Keys of the section `sim`.")

    def overrides(self) -> Dict[str, object]:
        """Dotted path -> value."""
        return {f"{section.name}.{key}": value for section in keys_of(type(self))  # type: ignore[arg-type]
                for key, value in getattr(self, section.name).items()}


@dataclass(frozen=True)
class ComparisonFile:
    """A file of config/comparisons."""

    name: str = setting(not_empty=True, help="Name of the comparison.")
    scenario: str = setting(not_empty=True, help="Base scenario of all runs.")
    tasks: Dict[str, TaskSettings] = setting(help="Starts by name.")
    laws: Dict[str, LawSettings] = setting(help="Laws by name.")
    description: str = setting("", help="One-line description.")
