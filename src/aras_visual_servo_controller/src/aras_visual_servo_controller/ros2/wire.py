"""Converts messages between the serialization of ROS 1 and that of ROS 2, CDR, without making objects of them.

A message class of ROS 1 describes its fields, and from these one Python function for each direction is compiled.
Numbers are copied as bytes, so that floating-point values, NaN among them, keep every bit.

ROS 1 packs fields without gaps. CDR (OMG DDS-RTPS 2.3, 10.2: plain CDR version 1, little endian) aligns each number to
its size, counted from the end of a header of four bytes, and ends texts with a zero. ROS 2's header has no `seq`.
"""

import importlib
import struct
from typing import Any, Callable, Dict, List, Tuple

from aras_visual_servo import ArasError

#: Primitive type of ROS 1 -> size in bytes. A time or a duration is two numbers of 4 bytes.
SIZES = {"bool": 1, "int8": 1, "uint8": 1, "byte": 1, "char": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4,
         "float32": 4, "int64": 8, "uint64": 8, "float64": 8}
TIMES = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
#: Names that ROS 2 gives to types.
RENAMED = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet", "char": "uint8",
           "Header": "std_msgs/Header"}
LITTLE_ENDIAN = b"\0\1\0\0"

Converter = Callable[[Any, int], bytes]


class WireError(ArasError):
    """A message cannot be converted."""


def fields_of(kind: Any) -> List[Tuple[str, str]]:
    """Returns (name, type) of each field of a message class as ROS 2 writes them, e.g. ("d", "sequence<double>")."""
    fields = []
    for name, slot in _slots(kind):
        base, array = _split(slot)
        two: str = TIMES.get(base) or RENAMED.get(base, base)
        fields.append((name.lower(), two if array is None else
                       f"sequence<{two}>" if array < 0 else f"{two}[{array}]"))
    return fields


def definitions_of(kind: Any) -> Dict[str, str]:
    """Returns ROS 2 type name -> text of its definition, of a message class of ROS 1 and of all types that it holds."""
    found, lines = {}, []
    for name, slot in _slots(kind):
        base, array = _split(slot)
        base = {"Header": "std_msgs/Header"}.get(base, TIMES.get(base, base))
        if "/" in base and base not in TIMES.values():
            found.update(definitions_of(_class_of(base)))
        if (kind._type, name) != ("std_msgs/Header", "seq"):
            lines.append(f"{base}{'' if array is None else '[]' if array < 0 else f'[{array}]'} {name.lower()}")
    return {**found, kind._type.replace("/", "/msg/"): "\n".join(lines) + "\n"}


def to_cdr(kind: Any) -> Converter:
    """Returns the function (ROS 1 bytes, unused) -> CDR bytes of a message class of ROS 1."""
    code = _Code()
    code.message_to_cdr(kind, "")
    return code.compiled(["out = bytearray(4)", "i = 0"], [f"out[:4] = {LITTLE_ENDIAN!r}", "return bytes(out)"])


def from_cdr(kind: Any) -> Converter:
    """Returns the function (CDR bytes, sequence number) -> ROS 1 bytes of a message class of ROS 1.

    The sequence number goes into the header, where the message begins with one. The function raises WireError: the
    bytes are not of this type, or big endian.
    """
    code = _Code()
    code.message_from_cdr(kind, "", top=True)
    return code.compiled([f"if data[:2] != {LITTLE_ENDIAN[:2]!r}:",
                          "    raise WireError('CDR: found encoding %s, allowed 0001' % bytes(data[:2]).hex())",
                          "out = bytearray()", "i = 4"], ["return bytes(out)"])


def _slots(kind):
    return list(zip(kind.__slots__, kind._slot_types))


def _split(slot):
    """(base type, length of the array) of a field's type; length None: no array, -1: any length."""
    base, bracket, length = slot.partition("[")
    return base, None if not bracket else int(length[:-1] or -1)


def _class_of(base):
    package, _, name = ("std_msgs/Header" if base == "Header" else base).partition("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError):
        raise WireError(f"{base}: this message is not installed") from None


def _align(size):
    """Pads `out` to a multiple of a size, counted after the header."""
    return [f"out += PAD[(4 - len(out)) % {size}]"] if size > 1 else []


def _skip(size):
    return [f"i += (4 - i) % {size}"] if size > 1 else []


class _Code:
    """Lines of one converter."""

    def __init__(self) -> None:
        self._lines: List[str] = []
        self._depth = 0

    def compiled(self, before: List[str], after: List[str]) -> Converter:
        """Returns the function, with these lines around it."""
        lines = [*before, *self._lines, *after]
        body = "\n        ".join(lines)
        source = (f"def convert(data, seq):\n    try:\n        {body}\n"
                  "    except (struct.error, IndexError) as error:\n"
                  "        raise WireError(f'a message of {len(data)} bytes: {error}') from None\n")
        names: Dict[str, Any] = {"struct": struct, "U32": struct.Struct("<I"), "WireError": WireError,
                                 "PAD": [b"\0" * n for n in range(8)]}
        exec(source, names)  # made of the field types above, of nothing that came over a wire
        return names["convert"]

    def _add(self, indent, *lines):
        self._lines += [indent + line for line in lines]

    def _loop(self, indent, count):
        self._depth += 1
        self._add(indent, f"for _{self._depth} in range({count}):")
        return indent + "    "

    # --- ROS 1 to CDR -------------------------------------------------------------------------------------------

    def message_to_cdr(self, kind: Any, indent: str) -> None:
        """Adds the lines for all fields of a message class."""
        if not kind.__slots__:
            self._add(indent, "out += b'\\0'")  # in ROS 2 an empty type has a byte
        for name, slot in _slots(kind):
            base, array = _split(slot)
            if kind._type == "std_msgs/Header" and name == "seq":
                self._add(indent, "i += 4")
            elif array is None:
                self._value_to_cdr(base, indent)
            else:
                if array < 0:
                    self._add(indent, "n, = U32.unpack_from(data, i)", "i += 4", *_align(4), "out += U32.pack(n)")
                if base in SIZES:
                    count = "n" if array < 0 else str(array)
                    inner = indent
                    if array < 0 and SIZES[base] > 4:
                        self._add(indent, "if n:")  # an empty sequence is not aligned
                        inner += "    "
                    self._add(inner, *_align(SIZES[base]), f"m = i + {SIZES[base]} * {count}",
                              "if m > len(data): raise IndexError('it ends too early')", "out += data[i:m]", "i = m")
                else:
                    self._value_to_cdr(base, self._loop(indent, "n" if array < 0 else array))

    def _value_to_cdr(self, base, indent):
        if base in SIZES:
            size = SIZES[base]
            self._add(indent, *_align(size), f"out += data[i:i + {size}]", f"i += {size}")
        elif base in TIMES:
            self._add(indent, *_align(4), "out += data[i:i + 8]", "i += 8")
        elif base == "string":
            self._add(indent, "k, = U32.unpack_from(data, i)", "i += 4", *_align(4),
                      "out += U32.pack(k + 1)", "out += data[i:i + k]", "out += b'\\0'", "i += k")
        else:
            self.message_to_cdr(_class_of(base), indent)

    # --- CDR to ROS 1 -------------------------------------------------------------------------------------------

    def message_from_cdr(self, kind: Any, indent: str, top: bool = False) -> None:
        """Adds the lines for all fields of a message class. Args: top: its header gets the sequence number."""
        if not kind.__slots__:
            self._add(indent, "i += 1")
        for index, (name, slot) in enumerate(_slots(kind)):
            base, array = _split(slot)
            if kind._type == "std_msgs/Header" and name == "seq":
                self._add(indent, f"out += U32.pack({'seq' if top else '0'})")
            elif array is None:
                if base in ("Header", "std_msgs/Header"):
                    self.message_from_cdr(_class_of("std_msgs/Header"), indent, top and index == 0)
                else:
                    self._value_from_cdr(base, indent)
            else:
                if array < 0:
                    self._add(indent, *_skip(4), "n, = U32.unpack_from(data, i)", "i += 4", "out += U32.pack(n)")
                if base in SIZES:
                    count = "n" if array < 0 else str(array)
                    inner = indent
                    if array < 0 and SIZES[base] > 4:
                        self._add(indent, "if n:")
                        inner += "    "
                    self._add(inner, *_skip(SIZES[base]), f"m = i + {SIZES[base]} * {count}",
                              "if m > len(data): raise IndexError('it ends too early')", "out += data[i:m]", "i = m")
                else:
                    self._value_from_cdr(base, self._loop(indent, "n" if array < 0 else array))

    def _value_from_cdr(self, base, indent):
        if base in SIZES or base in TIMES:
            size, align = (SIZES[base],) * 2 if base in SIZES else (8, 4)
            self._add(indent, *_skip(align), "if i >= len(data): raise IndexError('it ends too early')",
                      f"out += data[i:i + {size}]", f"i += {size}")
        elif base == "string":
            self._add(indent, *_skip(4), "k, = U32.unpack_from(data, i)", "i += 4",
                      "if i + k > len(data): raise IndexError('it ends too early')",
                      "k = max(k - 1, 0)", "out += U32.pack(k)", "out += data[i:i + k]", "i += k + 1")
        else:
            self.message_from_cdr(_class_of(base), indent)
