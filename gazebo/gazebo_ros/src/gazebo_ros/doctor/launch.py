"""Launch files: their includes, nodes and parameters, read without starting anything."""
import os
import re
import shlex
import subprocess
import sys
import typing
import xml.etree.ElementTree as ElementTree

import roslib.packages
import rospkg
from roslaunch.substitution_args import SubstitutionException, resolve_args

from ..node.folders import MODEL_PATH, RESOURCE_PATH, Folders
from ..node.program import EMPTY, parsed
from . import descriptions
from .findings import Finding, advice_for
from .lined import Lined
from .nodelets import Nodelets

XACRO_S = 60.0  #: wall time that xacro may take for a file
PASSING = re.compile("xacro: in-order processing|.*[Ww]arning:|when |instantiated from|in file:|Traceback| ")
Context = typing.Dict[str, typing.Any]  #: argument of roslaunch's resolve_args
SERVERS = ("gzserver", "gazebo", "debug", "perf")


class Launch:
    """Walks launch files.

    Attributes: findings: list of Finding.  packages: folders of the packages that were met, by name.
    """

    def __init__(self, folders: Folders) -> None:
        """Args: folders: Folders; their environment is changed by <env>."""
        self.findings, self.packages = [], {}
        self._folders, self._rospack, self._seen = folders, rospkg.RosPack(), set()
        self._nodelets = Nodelets(self._rospack)

    def walk(self, path: str, arguments: typing.Dict[str, str]) -> None:
        """Examines a launch file and its includes. Args: arguments: dict of its <arg>s."""
        key = path, tuple(sorted(arguments.items()))
        if key in self._seen:
            return
        self._seen.add(key)
        document = Lined(path)
        if document.root is None or document.fault:
            self._add("file", os.path.basename(path), path, document.fault or "is empty")
            return
        self._children(document, document.root, {"arg": dict(arguments), "filename": path}, dict(arguments))

    def _add(self, kind: str, what: str, where: str, advice: str) -> None:
        self.findings.append(Finding(kind, what, where, advice))

    def _children(self, document: Lined, parent: ElementTree.Element, context: Context,
                  given: typing.Dict[str, str]) -> None:
        for element in parent:
            if not self._wanted(document, element, context):
                continue
            if element.tag == "arg":
                self._argument(document, element, context, given)
            elif element.tag in ("include", "node", "rosparam", "param", "env"):
                getattr(self, "_" + element.tag)(document, element, context)
            if element.tag in ("group", "node"):
                self._children(document, element, {**context, "arg": dict(context["arg"])}, given)

    def _argument(self, document: Lined, element: ElementTree.Element, context: Context,
                  given: typing.Dict[str, str]) -> None:
        name = element.get("name", "")
        if "value" in element.attrib or name not in given:
            value = self._text(document, element, element.get("value", element.get("default")), context)
            if value is not None:
                context["arg"][name] = value

    def _wanted(self, document: Lined, element: ElementTree.Element, context: Context) -> bool:
        """Returns whether if and unless enable an element; an unresolvable condition enables it."""
        for key, wanted in (("if", True), ("unless", False)):
            value = self._text(document, element, element.get(key), context)
            if value is not None and (value.strip().lower() in ("true", "1")) != wanted:
                return False
        return True

    def _text(self, document: Lined, element: ElementTree.Element, text: typing.Optional[str],
              context: Context) -> typing.Optional[str]:
        """Returns a text with its $(...) in place, or None. Packages that it names and that are not there are findings.
        """
        if text is None:
            return None
        try:
            return resolve_args(text, context=context, filename=context["filename"])
        except rospkg.ResourceNotFound as error:
            self._missing_package(name_of(error), document.where(element))
        except (SubstitutionException, ValueError, TypeError, NameError, SyntaxError) as error:
            cause = error.__cause__ or error.__context__
            if isinstance(cause, rospkg.ResourceNotFound):
                self._missing_package(name_of(cause), document.where(element))
        return None

    def _missing_package(self, name: str, where: str) -> None:
        self._add("package", name, where, advice_for(name) or "is in no folder of ROS_PACKAGE_PATH")

    def package(self, name: str, where: str) -> typing.Optional[str]:
        """Returns the folder of a package, or None with a finding."""
        try:
            self.packages[name] = self._rospack.get_path(name)
        except rospkg.ResourceNotFound:
            self._missing_package(name, where)
            return None
        return self.packages[name]

    def package_of(self, path: str) -> None:
        """Takes the package of a file along, also one inside another, which ROS_PACKAGE_PATH does not lead to."""
        name = rospkg.get_package_name(path)
        if name in self._rospack.list():
            self.package(name, path)

    # --- tags of launch files

    def _include(self, document: Lined, element: ElementTree.Element, context: Context) -> None:
        path = self._text(document, element, element.get("file"), context)
        if path is None:
            return
        if not os.path.isfile(path):
            self._add("file", path, document.where(element), "is included and not there")
            return
        given = dict(context["arg"]) if element.get("pass_all_args", "false") in ("true", "1") else {}
        for argument in element.findall("arg"):
            if self._wanted(document, argument, context):
                value = self._text(document, argument, argument.get("value", argument.get("default")), context)
                if value is not None:
                    given[argument.get("name")] = value
        for variable in element.findall("env"):
            self._env(document, variable, context)
        self.package_of(path)
        self.walk(path, given)

    def _env(self, document: Lined, element: ElementTree.Element, context: Context) -> None:
        """Adds a launch file's folders of models and resources, for all that follows."""
        value = self._text(document, element, element.get("value"), context)
        if value and element.get("name") in (MODEL_PATH, RESOURCE_PATH):
            self._folders.environment[element.get("name")] = value

    def _node(self, document: Lined, element: ElementTree.Element, context: Context) -> None:
        package, kind = (self._text(document, element, element.get(key), context) for key in ("pkg", "type"))
        if not package or not kind:
            return
        where = document.where(element)
        if self.package(package, where) is None:
            return
        if not roslib.packages.find_node(package, kind, self._rospack):
            self._add("program", "%s/%s" % (package, kind), where, "is not there: has the package been built?")
        words = shlex.split(self._text(document, element, element.get("args", ""), context) or "")
        if package == "gazebo_ros" and kind in SERVERS:
            self._world(parsed(words)[0], where)
        elif package == "gazebo_ros" and kind == "spawn_model":
            self._spawned(words, where)
        elif package == "nodelet" and kind == "nodelet":
            self._nodelet(words, where)

    def _nodelet(self, words: typing.Sequence[str], where: str) -> None:
        fault = self._nodelets.fault(words)
        if fault is not None:
            self._add("nodelet", fault[0], where, advice_for(fault[0]) or fault[1])

    def _world(self, name: str, where: str) -> None:
        path = self._folders.resource(name) if name else None
        if path is not None:
            self.findings += descriptions.findings_of(path, self._folders)
        elif name not in EMPTY:
            self._add("file", name, where, "is the world, and not there")

    def _spawned(self, words: typing.Sequence[str], where: str) -> None:
        for key, word in zip(words, words[1:]):
            if key == "-database" and not self._folders(word):
                self._add("model", word, where, "is not there")
            elif key == "-file" and not os.path.isfile(word):
                self._add("file", word, where, "is spawned and not there")
            elif key == "-file":
                self.findings += descriptions.findings_of(word, self._folders)

    def _rosparam(self, document: Lined, element: ElementTree.Element, context: Context) -> None:
        path = self._text(document, element, element.get("file"), context)
        if path and element.get("command", "load") == "load" and not os.path.isfile(path):
            self._add("file", path, document.where(element), "is loaded and not there")

    def _param(self, document: Lined, element: ElementTree.Element, context: Context) -> None:
        where = document.where(element)
        path = self._text(document, element, element.get("textfile"), context)
        if path is not None and os.path.isfile(path):
            self.findings += descriptions.findings_of(path, self._folders)
        elif path is not None:
            self._add("file", path, where, "is read and not there")
        words = shlex.split(self._text(document, element, element.get("command"), context) or "")
        if words and os.path.basename(words[0]) in ("xacro", "xacro.py"):
            self._xacro(words[1:], where)

    def _xacro(self, words: typing.Sequence[str], where: str) -> None:
        file = next((word for word in words if not word.startswith("-") and ":=" not in word), "")
        if not os.path.isfile(file):
            self._add("file", file, where, "is expanded and not there")
            return
        try:
            done = subprocess.run([sys.executable, "-c", "import xacro_unprefixed; xacro_unprefixed.main()", *words],
                                  capture_output=True, text=True, timeout=XACRO_S, check=False)
        except subprocess.TimeoutExpired:
            self._add("xacro", file, where, "takes longer than %g s" % XACRO_S)
            return
        if done.returncode:
            lines = [line for line in done.stderr.splitlines() if line.strip() and not PASSING.match(line)]
            self._add("xacro", file, where, lines[0] if lines else "cannot be expanded")
        else:
            self.findings += descriptions.findings_of(file, self._folders, done.stdout)


def name_of(error: rospkg.ResourceNotFound) -> str:
    """Returns the name of the package that a rospkg.ResourceNotFound is about."""
    return str(error.args[0] if error.args else error).split("\n", maxsplit=1)[0].strip()
