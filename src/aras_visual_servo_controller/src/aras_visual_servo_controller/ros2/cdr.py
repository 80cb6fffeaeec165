"""Converts messages between the serialization of ROS 1 and that of ROS 2, CDR, without making objects of them.

From the fields of a message type one Python function for each direction is compiled. Numbers are copied as bytes, so
that floating-point values, NaN among them, keep every bit. Both sides of the relay load this file by itself.

ROS 1 packs fields without gaps. CDR (OMG DDS-RTPS 2.3, 10.2: plain CDR version 1, little endian) aligns each number to
its size, counted from the end of a header of four bytes, and ends texts with a zero. ROS 2's header has no `seq`.
"""

import struct
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, Type

#: Primitive type of ROS 1 -> size in bytes. A time or a duration is two numbers of 4 bytes.
SIZES = {"bool": 1, "int8": 1, "uint8": 1, "byte": 1, "char": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4,
         "float32": 4, "int64": 8, "uint64": 8, "float64": 8}
TIMES = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
LITTLE_ENDIAN = b"\0\1\0\0"
HEADER = "std_msgs/Header"

Converter = Callable[[Any, int], bytes]
#: Name of a message type of ROS 1, and of each that it holds -> (name, type) of its fields, as ROS 1 writes them.
Layout = Mapping[str, Sequence[Sequence[str]]]


def to_cdr(kind: str, layout: Layout, error: Type[Exception] = ValueError) -> Converter:
    """Returns the function (ROS 1 bytes, unused) -> CDR bytes of a message type. The function raises `error`."""
    code = _Code(layout)
    code.message_to_cdr(kind, "")
    return code.compiled(error, ["out = bytearray(4)", "i = 0"], [f"out[:4] = {LITTLE_ENDIAN!r}", "return bytes(out)"])


def from_cdr(kind: str, layout: Layout, error: Type[Exception] = ValueError) -> Converter:
    """Returns the function (CDR bytes, sequence number) -> ROS 1 bytes of a message type.

    The sequence number goes into the header, where the message begins with one. The function raises `error`: the bytes
    are not of this type, or big endian.
    """
    code = _Code(layout)
    code.message_from_cdr(kind, "", top=True)
    return code.compiled(error, [f"if data[:2] != {LITTLE_ENDIAN[:2]!r}:",
                                 "    raise Fault('CDR: found encoding %s, allowed 0001' % bytes(data[:2]).hex())",
                                 "out = bytearray()", "i = 4"], ["return bytes(out)"])


def split(slot: str) -> Tuple[str, Any]:
    """Returns (base type, length of the array) of a field's type; length None: no array, -1: any length."""
    base, bracket, length = slot.partition("[")
    return HEADER if base == "Header" else base, None if not bracket else int(length[:-1] or -1)


def _align(size):
    """Pads `out` to a multiple of a size, counted after the header."""
    return [f"out += PAD[(4 - len(out)) % {size}]"] if size > 1 else []


def _skip(size):
    return [f"i += (4 - i) % {size}"] if size > 1 else []


class _Code:
    """Lines of one converter."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._lines: List[str] = []
        self._depth = 0

    def compiled(self, error: Type[Exception], before: List[str], after: List[str]) -> Converter:
        """Returns the function, with these lines around it."""
        lines = [*before, *self._lines, *after]
        body = "\n        ".join(lines)
        source = (f"def convert(data, seq):\n    try:\n        {body}\n"
                  "    except (struct.error, IndexError) as error:\n"
                  "        raise Fault(f'a message of {len(data)} bytes: {error}') from None\n")
        names: Dict[str, Any] = {"struct": struct, "U32": struct.Struct("<I"), "Fault": error,
                                 "PAD": [b"\0" * n for n in range(8)]}
        exec(source, names)  # made of the field types above, of nothing that came over a wire
        return names["convert"]

    def _add(self, indent, *lines):
        self._lines += [indent + line for line in lines]

    def _loop(self, indent, count):
        self._depth += 1
        self._add(indent, f"for _{self._depth} in range({count}):")
        return indent + "    "

    def _numbers(self, size, array, aligned, indent):
        """Adds the lines that copy an array of numbers, after those that align its first one."""
        if array < 0 and size > 4:
            self._add(indent, "if n:")  # an empty sequence is not aligned
            indent += "    "
        self._add(indent, *aligned, f"m = i + {size} * {'n' if array < 0 else array}",
                  "if m > len(data): raise IndexError('it ends too early')", "out += data[i:m]", "i = m")

    # --- ROS 1 to CDR -------------------------------------------------------------------------------------------

    def message_to_cdr(self, kind: str, indent: str) -> None:
        """Adds the lines for all fields of a message type."""
        if not self._layout[kind]:
            self._add(indent, "out += b'\\0'")  # in ROS 2 an empty type has a byte
        for name, slot in self._layout[kind]:
            base, array = split(slot)
            if kind == HEADER and name == "seq":
                self._add(indent, "i += 4")
            elif array is None:
                self._value_to_cdr(base, indent)
            else:
                if array < 0:
                    self._add(indent, "n, = U32.unpack_from(data, i)", "i += 4", *_align(4), "out += U32.pack(n)")
                if base in SIZES:
                    self._numbers(SIZES[base], array, _align(SIZES[base]), indent)
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
            self.message_to_cdr(base, indent)

    # --- CDR to ROS 1 -------------------------------------------------------------------------------------------

    def message_from_cdr(self, kind: str, indent: str, top: bool = False) -> None:
        """Adds the lines for all fields of a message type. Args: top: its header gets the sequence number."""
        if not self._layout[kind]:
            self._add(indent, "i += 1")
        for index, (name, slot) in enumerate(self._layout[kind]):
            base, array = split(slot)
            if kind == HEADER and name == "seq":
                self._add(indent, f"out += U32.pack({'seq' if top else '0'})")
            elif array is None:
                if base == HEADER:
                    self.message_from_cdr(HEADER, indent, top and index == 0)
                else:
                    self._value_from_cdr(base, indent)
            else:
                if array < 0:
                    self._add(indent, *_skip(4), "n, = U32.unpack_from(data, i)", "i += 4", "out += U32.pack(n)")
                if base in SIZES:
                    self._numbers(SIZES[base], array, _skip(SIZES[base]), indent)
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
            self.message_from_cdr(base, indent)
