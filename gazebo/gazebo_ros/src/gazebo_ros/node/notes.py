"""Warnings that many elements of a description have in common, as one line each."""
import re
import typing

#: The simulator's message about an unknown element.
IGNORED = re.compile(r"^URDF string:\d+: <(?P<tag>[^>]+)>: (?:in <gazebo reference='(?P<gazebo>[^']*)'>: |"
                     r"link '(?P<link>[^']*)': )?ignored$")
MOST_NAMES = 4  #: of links and joints in a line


def summed_up(warnings: typing.List[str]) -> typing.List[str]:
    """The same warnings: equal ones once, and elements that are ignored in one line for each kind, in their order."""
    lines, places = {}, {}
    for warning in warnings:
        match = IGNORED.match(warning)
        if match is None:
            lines.setdefault(warning)
            continue
        tag = match["tag"]
        lines.setdefault(tag)
        places.setdefault(tag, []).append(match["gazebo"] or match["link"] or "")
    return [ignored(line, places[line]) if line in places else line for line in lines]


def ignored(tag: str, places: typing.List[str]) -> str:
    names = list(dict.fromkeys(place for place in places if place))
    more = " and %d more" % (len(names) - MOST_NAMES) if len(names) > MOST_NAMES else ""
    shown = ", ".join(names[:MOST_NAMES]) + more
    return "<%s>%s: ignored" % (tag, " of " + shown if shown else "")
