"""Message classes of ROS 1 as ROS 2 sees them: fields, definitions, and converters of their bytes."""

import importlib
from typing import Any, Dict, List, Tuple

from aras_visual_servo import ArasError

from . import cdr
from .cdr import HEADER, TIMES, split

#: Names that ROS 2 gives to types.
RENAMED = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet", "char": "uint8"}


class WireError(ArasError):
    """A message cannot be converted."""


def layout_of(kind: Any) -> Dict[str, List[Tuple[str, str]]]:
    """Returns the fields of a message class and of all types that it holds, see `cdr.Layout`. Raises WireError."""
    slots = list(zip(kind.__slots__, kind._slot_types))
    layout = {kind._type: slots}
    for _, slot in slots:
        base, _ = split(slot)
        if "/" in base and base not in layout:
            layout.update(layout_of(_class_of(base)))
    return layout


def fields_of(kind: Any) -> List[Tuple[str, str]]:
    """Returns (name, type) of each field of a message class as ROS 2 writes them, e.g. ("d", "sequence<double>")."""
    fields = []
    for name, slot in layout_of(kind)[kind._type]:
        base, array = split(slot)
        two: str = TIMES.get(base) or RENAMED.get(base, base)
        fields.append((name.lower(), two if array is None else
                       f"sequence<{two}>" if array < 0 else f"{two}[{array}]"))
    return fields


def definitions_of(kind: Any) -> Dict[str, str]:
    """Returns ROS 2 type name -> text of its definition, of a message class of ROS 1 and of all types that it holds."""
    found = {}
    for one, slots in layout_of(kind).items():
        lines = []
        for name, slot in slots:
            base, array = split(slot)
            if (one, name) != (HEADER, "seq"):
                lines.append(f"{TIMES.get(base, base)}{'' if array is None else '[]' if array < 0 else f'[{array}]'} "
                             f"{name.lower()}")
        found[one.replace("/", "/msg/")] = "\n".join(lines) + "\n"
    return found


def to_cdr(kind: Any) -> cdr.Converter:
    """Returns the function (ROS 1 bytes, unused) -> CDR bytes of a message class. It raises WireError."""
    return cdr.to_cdr(kind._type, layout_of(kind), WireError)


def from_cdr(kind: Any) -> cdr.Converter:
    """Returns the function (CDR bytes, sequence number) -> ROS 1 bytes of a message class, see `cdr.from_cdr`."""
    return cdr.from_cdr(kind._type, layout_of(kind), WireError)


def _class_of(base):
    package, _, name = base.partition("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError):
        raise WireError(f"{base}: this message is not installed") from None
