"""Findings of the doctor, and their table."""
import dataclasses
import typing

import rospkg

#: Kinds of findings, in the order of the table.
KINDS = ("package", "file", "program", "nodelet", "syntax", "python 2", "module", "xacro", "plugin", "model", "mesh")
#: Prefixes of package and module names -> project.
KNOWN = (("moveit", "MoveIt, which Debian 12 does not have: launch files and nodes that plan with it do not run"),
         ("ompl", "OMPL's planners, part of MoveIt"), ("rosbridge", "rosbridge_suite: not in Debian 12"),
         ("rqt", "a window of rqt, which Debian 12 does not have"), ("mav_msgs", "mav_comm: build it in the workspace"),
         ("hardware_interface", "ros_control's C++ headers: nodes that are controllers themselves do not build"),
         ("controller_interface", "ros_control's C++ headers: controllers in C++ do not build"),
         ("cv_bridge", "`script/bootstrap --gazebo` installs it"), ("tf", "`script/bootstrap --gazebo` installs it"))


@dataclasses.dataclass(frozen=True)
class Finding:
    """A missing dependency. Attributes: kind: of KINDS.  what: its name.  where: FILE:LINE.  advice: its project, or
    the remedy."""
    kind: str
    what: str
    where: str = ""
    advice: str = ""


def advice_for(name: str) -> str:
    """Returns the project of a package or module, "" if it is unknown."""
    if name.endswith("_moveit_config"):
        return KNOWN[0][1]
    return next((advice for start, advice in KNOWN if name == start or name.startswith(start)), "")


def shortened(where: str, packages: typing.Optional[rospkg.RosPack]) -> str:
    """Returns FILE:LINE with the name of the package in place of its folder. Args: packages: rospkg.RosPack or None."""
    name = rospkg.get_package_name(where.rpartition(":")[0] or where) if packages is not None else None
    if not name:
        return where
    try:
        return where.replace(packages.get_path(name), name, 1)
    except rospkg.ResourceNotFound:
        return where


def table(findings: typing.Iterable[Finding], packages: typing.Optional[rospkg.RosPack] = None) -> typing.List[str]:
    """Returns one line for each missing thing, sorted by kind, without duplicates. Args: packages: as shortened()."""
    rows = {}
    for finding in sorted(findings, key=lambda each: (KINDS.index(each.kind), each.what, each.where)):
        rows.setdefault((finding.kind, finding.what), finding)
    cells = [(each.kind, shortened(each.what, packages), shortened(each.where, packages), each.advice)
             for each in rows.values()]
    if not cells:
        return []
    cells.insert(0, ("kind", "name", "where", "note"))
    widths = [max(len(row[k]) for row in cells) for k in range(3)]
    lines = ["  ".join([*(cell.ljust(width) for cell, width in zip(row, widths)), row[3]]).rstrip() for row in cells]
    return [lines[0], "-" * len(lines[0]), *lines[1:]]
