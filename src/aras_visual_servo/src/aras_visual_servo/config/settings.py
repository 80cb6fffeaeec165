"""Settings as frozen dataclasses: every key is described once, and read, checked and documented from there.

    @dataclass(frozen=True)
    class BoundedSettings:
        max_speed_m_s: float = setting(0.1, unit="m/s", above=0, help="The camera moves no faster than this.")

    read(BoundedSettings, {"max_speed_m_s": 0.2}, "servo/bounded")      # config/reader.py: an instance, or all faults
    schema_of(BoundedSettings)                                          # config/schema.py: JSON Schema

A key is a field made by `setting`; its type is the annotation:

| annotation | in YAML |
|---|---|
| `float`, `int`, `bool`, `str` | a finite number, a whole number, true or false, a text |
| `Tuple[float, ...]`, `Tuple[str, ...]` | a list; `size` of them |
| `Tuple[float, ...]` with `by="feature"` | a number for each feature by its name; the tuple has their order |
| `Dict[str, X]` | an X for each name; with `by="joint"` the names are those of joints, with `by="joint_position"` the |
| | numbers are their positions, within their limits |
| a settings class | a section of its own |
| `Optional[X]` | an X; None without it |
| `object` | anything |

A field without `setting` is no key. A class may have `check(self)`, which yields faults that concern several keys
together, each as "key: found X, allowed Y". It is called when every key by itself is right.
"""

import functools
import typing
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from typing import Any, Callable, Iterable, Mapping, Optional, Tuple, TypeVar

from ..ground.errors import ParameterError
from ..ground.registry import Registry

C = TypeVar("C")
#: Kinds of names for the entries of a key whose number depends on the scenario.
BY = ("", "feature", "joint", "joint_position")
_SCALARS = (float, int, bool, str, object)
_KEY, _NONE = "aras_setting", type(None)


@dataclass(frozen=True)
class Key:
    """Description of one key.

    Attributes:
        name.  type: the annotation without Optional.  optional: None stands for a key that is not there.
        default: MISSING if the key is required.  help: its meaning, in one line.  unit: "" if it has none.
        above, at_least, below, at_most: bounds of a number, or of each in a list or table; None: unbounded.
        choices: texts allowed.  size: of a list.  not_empty: a text, list or table has at least one entry.
        condition: (text of the allowed values, function that tests an otherwise valid value), or None.
        by: one of BY.
    """

    name: str
    type: Any
    optional: bool
    default: Any
    help: str
    unit: str = ""
    above: Optional[float] = None
    at_least: Optional[float] = None
    below: Optional[float] = None
    at_most: Optional[float] = None
    choices: Tuple[str, ...] = ()
    size: Optional[int] = None
    not_empty: bool = False
    condition: Optional[Tuple[str, Callable]] = None
    by: str = ""

    @property
    def required(self) -> bool:
        """Whether it has no default."""
        return self.default is MISSING


def setting(default: Any = MISSING, *, help: str, unit: str = "", above: Optional[float] = None,
            at_least: Optional[float] = None, below: Optional[float] = None, at_most: Optional[float] = None,
            choices: Iterable[str] = (), size: Optional[int] = None, not_empty: bool = False,
            condition: Optional[Tuple[str, Callable]] = None, by: str = "") -> Any:
    """Field of a settings class that is a key; the arguments are those of `Key`. Without default it is required."""
    more = {"help": help, "unit": unit, "above": above, "at_least": at_least, "below": below, "at_most": at_most,
            "choices": tuple(choices), "size": size, "not_empty": not_empty, "condition": condition, "by": by}
    if isinstance(default, dict):
        return field(default_factory=lambda: dict(default), metadata={_KEY: more})
    return field(default=default, metadata={_KEY: more})


def register(registry: Registry[Any], name: str, settings: Optional[type], /,
             **attributes: Any) -> Callable[[C], C]:
    """Returns a class decorator that makes a plugin known by name, with settings of its own or None.

    Args: settings: class of the settings, read from the section `servo.NAME`.  attributes: of the plugin.
    Raises ParameterError: `settings` is not a frozen dataclass whose fields are made by `setting`.
    """
    if settings is not None:
        keys_of(settings)
    return registry.register(name, settings_class=settings, **attributes)


@functools.lru_cache(maxsize=None)
def keys_of(cls: Any) -> Tuple[Key, ...]:
    """Keys of a settings class, tuple of `Key` in the order in which they are written down.

    Raises ParameterError: the class is no frozen dataclass, or a key has no help or a type that no key can have.
    """
    if not (is_dataclass(cls) and cls.__dataclass_params__.frozen):
        raise ParameterError(f"settings {cls.__name__}: found no frozen dataclass")
    hints, found = typing.get_type_hints(cls), []
    for entry in fields(cls):
        more = entry.metadata.get(_KEY)
        if more is None:
            continue
        kind, optional = _without_none(hints[entry.name])
        default = entry.default if entry.default_factory is MISSING else entry.default_factory()
        key = Key(entry.name, kind, optional, default, **more)
        if not (key.help and "\n" not in key.help) or not _readable(key) or key.by not in BY:
            raise ParameterError(f"settings {cls.__name__}.{entry.name}: found {hints[entry.name]}, help '{key.help}', "
                                 f"by '{key.by}', allowed a type that config/settings.py lists and a line of help")
        found.append(key)
    return tuple(found)


def required_keys(cls: type) -> Tuple[str, ...]:
    """Names of the keys without a default."""
    return tuple(key.name for key in keys_of(cls) if key.required)


def settings_of(name: str, cls: type, given: Mapping[str, Any], what: str) -> Any:
    """Settings of one law or feature that has a section of its own.

    Args: name: of the section.  cls: its settings class.  given: sections by name.  what: "law 'mine'", for the error.
    Returns: given[name], else the defaults. Raises ParameterError: a key has no default, or the type differs.
    """
    if name not in given:
        needed = required_keys(cls)
        if needed:
            raise ParameterError(f"{name}: found nothing, {what} needs {' and '.join(needed)}")
        return cls()
    if not isinstance(given[name], cls):
        raise ParameterError(f"{name}: found {given[name]}, {what} takes {cls.__name__}")
    return given[name]


def entry_type(kind: Any) -> Any:
    """Returns the element type X of Tuple[X, ...] and Dict[str, X]; None for other types."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
        return arguments[0]
    if origin is dict and len(arguments) == 2 and arguments[0] is str:
        return arguments[1]
    return None


def is_table(key: Key) -> bool:
    """Whether the key is given by names: one entry for each feature, joint or whatever it is a table of."""
    return typing.get_origin(key.type) is dict or key.by == "feature"


def _without_none(hint):
    """(type without Optional, whether it was Optional)."""
    arguments = typing.get_args(hint)
    kinds = [kind for kind in arguments if kind is not _NONE]
    if typing.get_origin(hint) is typing.Union and len(arguments) == 2 and len(kinds) == 1:
        return kinds[0], True
    return hint, False


def _readable(key):
    kind = key.type
    while entry_type(kind) is not None:
        kind = entry_type(kind)
    if is_dataclass(kind):
        return bool(keys_of(kind))
    return kind in _SCALARS and (key.by != "feature" or key.type == Tuple[float, ...])
