"""The tree of links and joints of a URDF: urdfdom's checks, parents and children."""
import typing
import xml.etree.ElementTree as ElementTree

from aras_visual_servo_sim import ModelError

from ..faults import REFUSED

WORLD = "world"  #: the root link that is the world itself
DESCRIBED_BY = "described_by"  #: attribute of <robot>: "sdf" where the document was written from one of SDF
#: Of <gazebo reference=JOINT>: the fixed joint's child stays a link of its own.
PRESERVED = ("preserveFixedJoint", "disableFixedJointLumping")


def check_tree(robot: ElementTree.Element) -> None:
    """Checks the rules by which urdfdom, and so Gazebo, rejects a whole robot: names, and links that form no tree.

    Raises: ModelError: names the first link or joint, the value found and the allowed ones.
    """
    links = names_of(robot, "link")
    names_of(robot, "joint")
    parents: typing.Dict[str, str] = {}
    for joint in robot.findall("joint"):
        what = "joint '%s'" % joint.get("name")
        ends = {}
        for tag in ("parent", "child"):
            end = joint.find(tag)
            name = None if end is None else end.get("link")
            if name not in links:
                raise refused("%s: %s link [%s] of it not found, allowed is a <link> of the document" %
                              (what, tag, name or ""))
            ends[tag] = name
        if ends["child"] in parents:
            raise refused("%s: found child link '%s', which has another parent already, allowed is one parent" %
                          (what, ends["child"]))
        parents[ends["child"]] = ends["parent"]
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        found = "%d root links (%s)" % (len(roots), ", ".join(roots)) if roots else "no root link: the joints loop"
        raise refused("found %s, allowed is one link that every other hangs from" % found)
    for link in links:
        at, passed = link, set()
        while at in parents:
            if at in passed:
                raise refused("link '%s': found a loop of joints, allowed is a tree" % link)
            passed.add(at)
            at = parents[at]


def refused(text: str) -> ModelError:
    """Returns the error of a document that cannot be a robot."""
    return ModelError(REFUSED + text)


def names_of(robot: ElementTree.Element, tag: str) -> typing.List[str]:
    """Returns the names of all links or joints, in the order of the document. Raises: ModelError: none, or one twice.
    """
    names: typing.List[str] = []
    for k, element in enumerate(robot.findall(tag)):
        name = element.get("name", "")
        if not name.strip():
            raise refused("<%s> number %d: found no name, allowed is one" % (tag, k + 1))
        if name in names:
            raise refused("%s '%s': found this name twice, allowed once" % (tag, name))
        names.append(name)
    if tag == "link" and not names:
        raise refused("found no <link>, allowed are one or more")
    return names


def link_of(joint: ElementTree.Element, tag: str) -> str:
    """Returns the link at a joint's <parent> or <child>; the tree was checked."""
    end = joint.find(tag)
    assert end is not None
    return end.get("link", "")


class Tree:
    """Links and joints by parent and child; the tree was checked."""

    def __init__(self, robot: ElementTree.Element) -> None:
        self.joints = {link_of(joint, "child"): joint for joint in robot.findall("joint")}  #: by child link
        self.children: typing.Dict[str, typing.List[str]] = {name: [] for name in names_of(robot, "link")}
        # As urdfdom has them: in the order of their joints' names.
        for joint in sorted(robot.findall("joint"), key=lambda each: each.get("name", "")):
            self.children[link_of(joint, "parent")].append(link_of(joint, "child"))
        self.root = next(name for name in self.children if name not in self.joints)

    def below(self, link: str) -> typing.List[str]:
        """Returns a link and all that hang from it, parents first, in the order of sdformat's CreateSDF."""
        found, waiting = [], [link]
        while waiting:
            found.append(waiting.pop())
            waiting.extend(reversed(self.children[found[-1]]))
        return found

    def body(self, link: str) -> typing.List[str]:
        """Returns a link and all that fixed joints hold at it."""
        found, waiting = [], [link]
        while waiting:
            found.append(waiting.pop())
            waiting.extend(child for child in self.children[found[-1]] if self.joints[child].get("type") == "fixed")
        return found


def lumped_links(robot: ElementTree.Element) -> typing.List[str]:
    """Returns the links that Gazebo has of a model, in its order: of SDF all, as the document has them.

    Of a URDF a fixed joint puts its child into its parent, unless the parent is `world`, or a <gazebo> tag about the
    joint says preserveFixedJoint or disableFixedJointLumping; links come depth first, the joints of a link by name
    (ReduceFixedJoints, FixedJointShouldBeReduced and CreateSDF in parser_urdf.cc of sdformat; child_links of urdfdom).
    """
    if robot.get(DESCRIBED_BY) == "sdf":
        return [link for link in names_of(robot, "link") if link != WORLD]
    kept = {gazebo.get("reference") for gazebo in robot.findall("gazebo") for tag in PRESERVED
            for said in gazebo.findall(tag) if (said.text or "").strip().lower() in ("true", "1")}
    tree = Tree(robot)

    def lumped(link: str) -> bool:
        joint = tree.joints.get(link)
        return joint is not None and joint.get("type") == "fixed" and joint.get("name") not in kept and \
            link_of(joint, "parent") != WORLD

    return [link for link in tree.below(tree.root) if link != WORLD and not lumped(link)]
