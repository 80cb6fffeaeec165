"""gazebo-doctor: what a package asks for that is not there."""
import os

import pytest
import rospkg

from gazebo_ros.doctor.findings import Finding, table
from gazebo_ros.doctor.nodelets import Nodelets
from gazebo_ros.doctor.program import main
from gazebo_ros.doctor.python import findings_of

PACKAGE = ('<package format="2"><name>%s</name><version>0.0.1</version><description>A robot.</description>'
           '<maintainer email="somebody@example.com">Somebody</maintainer><license>BSD</license>'
           '<export><nodelet plugin="${prefix}/nodelets.xml"/></export></package>')
FILES = {
    "launch/all.launch": """<launch>
  <arg name="world" default="$(find doctor_robot)/worlds/w.world"/><arg name="plans" default="false"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch"><arg name="world_name" default="$(arg world)"/>
  <env name="GAZEBO_MODEL_PATH" value="$(find doctor_robot)/models:$(optenv GAZEBO_MODEL_PATH)"/></include>
  <param name="robot_description" command="$(find xacro)/xacro $(find doctor_robot)/urdf/r.xacro"/>
  <include if="$(arg plans)" file="$(find doctor_robot_moveit_config)/launch/move_group.launch"/>
  <node pkg="doctor_robot" type="servo.py" name="s"/><node pkg="doctor_robot" type="compiled" name="c"/>
  <node pkg="moveit_ros_move_group" type="move_group" name="m"/>
  <rosparam file="$(find doctor_robot)/config/none.yaml"/>
</launch>
""",
    "launch/nodelets.launch": """<launch>
  <arg name="at" default="/cam/manager"/>
  <node pkg="nodelet" type="nodelet" name="m" args="manager"/>
  <node pkg="nodelet" type="nodelet" name="a" args="load doctor_robot/there $(arg at) --no-bond"/>
  <node pkg="nodelet" type="nodelet" name="b" args="load doctor_robot/unbuilt $(arg at)"/>
  <node pkg="nodelet" type="nodelet" name="c" args="load doctor_robot/unlisted $(arg at)"/>
  <node pkg="nodelet" type="nodelet" name="d" args="standalone nowhere/Mux"/>
  <node pkg="nodelet" type="nodelet" name="f" args="unload nowhere/Gone $(arg at)"/>
</launch>
""",
    "nodelets.xml": """<class_libraries><library path="lib/libdoctor_there">
<class name="doctor_robot/there" type="d::There" base_class_type="nodelet::Nodelet"/></library>
<library path="lib/libdoctor_unbuilt"><class type="doctor_robot/unbuilt" base_class_type="nodelet::Nodelet"/></library>
</class_libraries>""",
    "lib/libdoctor_there.so": "",
    "models/cup/model.config": "<model/>",
    "worlds/w.world": """<sdf version="1.6"><world name="d"><include><uri>model://cup</uri></include><!-- a -- b --->
<include><uri>model://willowgarage</uri></include>
<plugin name="x" filename="libweather.so"/><plugin name="y" filename="libgazebo_ros_link_attacher.so"/></world></sdf>
""",
    "urdf/r.xacro": """<robot name="r"><link name="a"><visual><geometry>
<mesh filename="package://doctor_robot/meshes/a.stl"/></geometry></visual></link>
<gazebo><plugin name="p" filename="libfancy.so"/><plugin name="q" filename="libgazebo_ros_control.so"/></gazebo></robot>
""",
    "scripts/servo.py": "#!/usr/bin/env python\nimport rospy\nprint 'hello'\n",
    "scripts/plan.py": "#!/usr/bin/env python\nimport moveit_commander\nfor i in xrange(3):\n    pass\n",
    "tools/helper.py": "import re\n",
    "scripts/user.py": "import sys\nsys.path.append('../tools')\nimport helper\n",
    "scripts/merged.py": "import os\n<<<<<<< HEAD\nimport re\n=======\n>>>>>>> main\n",
    "scripts/fine.py": "import plan\nimport os\nxrange = range\nprint(os, plan, xrange)\n",
}


@pytest.fixture
def robot(tmp_path, monkeypatch):
    """A package with everything that can be missing. Returns its folder."""
    folder = tmp_path / "doctor_robot"
    for name, text in {**FILES, "package.xml": PACKAGE % "doctor_robot"}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
        if name.startswith("scripts/"):
            (folder / name).chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", "%s:%s" % (tmp_path, os.environ.get("ROS_PACKAGE_PATH", "")))
    return folder


def rows(capsys, *words):
    """Exit status, and the first three columns of the table."""
    status = main(words)
    lines = capsys.readouterr().out.splitlines()[2:]
    return status, {tuple(line.replace("python 2", "python2").split()[:3]) for line in lines}


def test_everything_that_is_missing_is_a_row_with_file_and_line(robot, capsys):
    status, found = rows(capsys, "doctor_robot", "all.launch")
    assert status == 1
    assert found == {
        ("package", "moveit_ros_move_group", "doctor_robot/launch/all.launch:8"),
        ("file", "doctor_robot/config/none.yaml", "doctor_robot/launch/all.launch:9"),
        ("program", "doctor_robot/compiled", "doctor_robot/launch/all.launch:7"),
        ("syntax", "merged.py", "doctor_robot/scripts/merged.py:2"),
        ("python2", "servo.py", "doctor_robot/scripts/servo.py:3"),
        ("python2", "plan.py", "doctor_robot/scripts/plan.py:3"),
        ("module", "moveit_commander", "doctor_robot/scripts/plan.py:2"),
        ("plugin", "libweather.so", "doctor_robot/worlds/w.world:3"),
        ("plugin", "libfancy.so", "doctor_robot/urdf/r.xacro"),
        ("model", "model://willowgarage", "doctor_robot/worlds/w.world:2"),
        ("mesh", "package://doctor_robot/meshes/a.stl", "doctor_robot/urdf/r.xacro")}


def test_another_python_that_comes_first_in_the_path_is_named(robot, tmp_path, monkeypatch, capsys):
    other = tmp_path / "pyenv" / "python3"
    other.parent.mkdir()
    other.write_text("#!/bin/sh\n")
    other.chmod(0o755)
    monkeypatch.setenv("PATH", "/usr/bin:" + os.environ["PATH"])
    assert not any(row[:2] == ("program", "python3") for row in rows(capsys, "doctor_robot", "all.launch")[1])
    monkeypatch.setenv("PATH", "%s:%s" % (other.parent, os.environ["PATH"]))
    assert any(row[:2] == ("program", "python3") for row in rows(capsys, "doctor_robot", "all.launch")[1])


def test_arguments_of_the_launch_file_count(robot, capsys):
    _, found = rows(capsys, "doctor_robot", "all.launch", "plans:=true", "world:=worlds/empty.world")
    assert ("package", "doctor_robot_moveit_config", "doctor_robot/launch/all.launch:6") in found
    assert not {what for what, *_ in found} & {"model"}


def test_nodelets_that_are_unlisted_or_not_built_are_named(robot, capsys):
    _, found = rows(capsys, "doctor_robot", "nodelets.launch")
    assert {row for row in found if row[0] == "nodelet"} == {
        ("nodelet", "doctor_robot/unbuilt", "doctor_robot/launch/nodelets.launch:5"),
        ("nodelet", "doctor_robot/unlisted", "doctor_robot/launch/nodelets.launch:6"),
        ("nodelet", "nowhere/Mux", "doctor_robot/launch/nodelets.launch:7")}


def test_a_list_of_nodelets_that_a_package_of_debian_lacks_is_in_its_other_package(robot, monkeypatch):
    nodelets = Nodelets(rospkg.RosPack())
    assert nodelets.fault(["load", "doctor_robot/there", "/m"]) is None
    (robot / "nodelets.xml").unlink()
    assert "nodelets.xml" in Nodelets(rospkg.RosPack()).fault(["load", "doctor_robot/there"])[1]
    packages = rospkg.RosPack()
    packages.get_manifest("doctor_robot")  # is kept
    monkeypatch.setattr(packages, "get_path", lambda name: "/usr/share/" + name)
    assert "libdoctor-robot-dev" in Nodelets(packages).fault(["load", "doctor_robot/there"])[1]


def test_a_launch_file_without_a_fault_gives_no_table(robot, capsys):
    (robot / "launch" / "good.launch").write_text('<launch><node pkg="rostopic" type="rostopic" name="t"/></launch>')
    for name in ("servo.py", "plan.py", "merged.py"):
        (robot / "scripts" / name).unlink()
    (robot / "scripts" / "fine.py").write_text("print('fine')\n")
    assert main(["doctor_robot", "good.launch"]) == 0
    assert main(["doctor_robot", "none.launch"]) == 2 and main(["no_such_package", "a.launch"]) == 2


def test_moveit_is_named_and_each_thing_once():
    twice = [Finding("module", "moveit_commander", "a.py:1", "MoveIt"), Finding("module", "moveit_commander", "b.py:9")]
    lines = table(twice)
    assert len(lines) == 3 and "a.py:1" in lines[2] and table([]) == []


def test_files_of_python_3_have_no_findings(tmp_path):
    file = tmp_path / "new.py"
    file.write_text("import os\ndef cmp(a, b):\n    return a - b\nprint(os, cmp(1, 2))\n")
    assert findings_of(str(file)) == []
    file.write_text("import Queue\n")
    assert [(each.kind, each.where) for each in findings_of(str(file))] == [("python 2", "%s:1" % file)]
