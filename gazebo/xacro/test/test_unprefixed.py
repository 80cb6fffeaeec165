"""Tags without the prefix `xacro:`."""
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "scripts" / "xacro"
HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'


def expanded(folder, text, **others):
    """Root of what xacro makes of a text, None where it fails, and what it says."""
    for name, content in {**others, "main": text}.items():
        (folder / (name + ".xacro")).write_text(content, encoding="utf-8")
    done = subprocess.run([sys.executable, str(SCRIPT), str(folder / "main.xacro")], capture_output=True, text=True,
                          check=False)
    return ElementTree.fromstring(done.stdout) if done.returncode == 0 else None, done.stderr


def test_keywords_without_the_prefix_are_taken_and_named_with_file_and_line(tmp_path):
    robot, said = expanded(tmp_path, HEAD + """<property name="PI_HALF" value="1.5"/>
<include filename="part.xacro"/>
<link name="a"/><if value="1"><link name="yes"/></if><unless value="1"><link name="no"/></unless>
<joint name="j" type="fixed"><origin rpy="0 ${PI_HALF} 0"/></joint></robot>""",
                           part=HEAD + '\n<macro name="part" params="n"><link name="${n}"/></macro></robot>')
    assert [link.get("name") for link in robot.findall("link")] == ["a", "yes"]
    assert robot.find("joint/origin").get("rpy") == "0 1.5 0"
    lines = said.splitlines()
    assert any("main.xacro" in line and "2 <property>, 3 <include>, 4 <if>, 4 <unless>" in line for line in lines)
    assert any("part.xacro" in line and "3 <macro>" in line for line in lines)
    assert "sed -i" in said


def test_a_macro_called_without_the_prefix_is_expanded(tmp_path):
    robot, said = expanded(tmp_path, HEAD + """<xacro:macro name="box" params="n"><link name="${n}"/></xacro:macro>
<xacro:macro name="wheel" params="name"><link name="${name}"/></xacro:macro>

<wheel name="base"/><link name="b"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>""")
    assert [link.get("name") for link in robot.findall("link")] == ["base", "b"]
    assert robot.find("link/visual/geometry/box").get("size") == "1 1 1", "a tag of URDF stays one"
    assert "5 <wheel>" in said and "<box>" not in said


def test_files_with_prefixes_say_nothing_and_plugins_keep_their_tags(tmp_path):
    robot, said = expanded(tmp_path, HEAD + """<xacro:property name="x" value="2"/><link name="l${x}"/>
<gazebo><plugin name="p" filename="f"><property name="mine" value="1"/></plugin></gazebo></robot>""")
    assert robot.find("gazebo/plugin/property").get("name") == "mine"
    assert (robot.find("link").get("name"), said) == ("l2", "")
    assert expanded(tmp_path, HEAD + '<link name="${nothing}"/></robot>')[0] is None


def test_old_documents_may_call_macros_that_nobody_defines_and_have_properties_without_a_name(tmp_path):
    rest = '<xacro:property name="" value="1"/>\n<xacro:wheel n="a"/><link name="b"/></robot>'
    robot, said = expanded(tmp_path, HEAD + '<property name="x" value="2"/>\n' + rest)
    assert [element.get("name") for element in robot] == ["b"]
    assert any("main.xacro:3: <xacro:property>" in line for line in said.splitlines())
    assert any("main.xacro:4: <xacro:wheel>" in line for line in said.splitlines())
    assert expanded(tmp_path, HEAD + rest)[0] is None, "a document with prefixes is read as ROS Noetic reads it"
    assert expanded(tmp_path, HEAD + rest.split("\n")[1])[0] is None
