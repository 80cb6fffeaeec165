"""docs/your_arm.md, run as it stands there, from a folder of its own: a URDF that is not in the list of arms."""
import pathlib
import re
import shlex

import pytest

import aras_visual_servo as avs
from aras_visual_servo.cli.main import main
from aras_visual_servo.config.files import arm_names
from aras_visual_servo.cli.robot_check import text_of
from aras_visual_servo.arm.urdf_check import shortcomings

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "your_arm.md"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the page's URDF."""
    [urdf] = re.findall(r"```xml\n(.*?)```", PAGE.read_text(), re.DOTALL)
    (tmp_path / "my_arm.urdf").write_text(urdf)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def commands():
    """The page's lines that are typed, without those of the named arms and those over ROS."""
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    lines = [line.partition("#")[0].strip() for language, text in blocks if not language for line in text.splitlines()]
    return [shlex.split(line)[1:] for line in lines
            if "my_arm" in line and "--ros" not in line and line.startswith("aras-servo ")]


def test_every_line_of_the_page_does_what_it_says(folder):
    typed = commands()
    assert len(typed) == 4
    for words in typed:
        assert main(words) == 0, words
    assert len(list((folder / "results").glob("*/*/summary.json"))) == 2


def test_the_page_lists_the_arms_that_there_are():
    listed = re.findall(r"^\| `(\w+)` \|[^|]*\| (\d) \| .*?(?:`(\S+)`|none[^|]*) \|$", PAGE.read_text(), re.MULTILINE)
    assert sorted(name for name, _, _ in listed) == arm_names()
    for name, axes, controller in listed:
        scenario = avs.load_scenario(name)
        assert len(scenario.kinematics().joint_names) == int(axes)
        assert scenario.real["controller"] == controller or not controller


SPOILT = {
    "velocity": ('velocity="2" effort="100"', 'effort="100"', "joint turn: limit.velocity"),
    "degrees": ('lower="-2.6" upper="2.6"', 'lower="-150" upper="150"', "joint elbow: limit"),
    "mass": ('<mass value="3"/>', "", "link upper: mass"),
    "inertia": ('ixx="0.004" iyy="0.004" izz="0.001"', 'ixx="0.004" iyy="0.004" izz="0.1"', "link wrist: inertia"),
    "mesh": ('<link name="base"/>', '<link name="base"><visual><geometry><mesh filename="no.stl"/></geometry></visual>'
             '</link>', "mesh: found no.stl"),
    "type": ('name="tool" type="continuous"', 'name="tool" type="planar"', "joint tool"),
}


def test_everything_that_a_urdf_lacks_is_named_at_once(folder, capsys):
    text = (folder / "my_arm.urdf").read_text()
    for old, new, _ in SPOILT.values():
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "my_arm.urdf").write_text(text)
    assert main(["robot", "check", "my_arm.urdf", "--tip", "flnge"]) == 1
    said = capsys.readouterr().out
    for begin in [begin for _, _, begin in SPOILT.values()] + ["tip: found no link flnge", "camera: found no link"]:
        assert begin in said
    assert main(["robot", "add", "my_arm.urdf", "--tip", "flange", "--camera-xyz", "0", "0", "0"]) == 2
    assert not (folder / "my_arm").exists()


def test_a_singular_home_and_a_camera_that_moves_against_the_flange_are_named(folder):
    text, tip = text_of("my_arm.urdf"), "flange"
    assert shortcomings(text, tip, "hand", folder)[0].startswith("camera: found hand")
    parallel = text.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')  # the camera stays in a plane
    faults = shortcomings(parallel, tip, tip, folder)
    assert len(faults) == 1 and faults[0].startswith("home: ")
    assert shortcomings("<robot", tip, tip)[0].startswith("URDF: ")
    two = '<robot><link name="a"/><link name="b"/></robot>'
    assert shortcomings(two, "a", "b")[0].startswith("root link: found a, b")


def test_bad_arguments_of_add_are_named(folder, capsys):
    add = ["robot", "add", "my_arm.urdf", "--tip", "flange", "--camera-xyz", "0", "0", "0"]
    for more, begin in ((["--home", "elbow"], "--home: found elbow"), (["--home", "elbo=1"], "home: found joint elbo"),
                        (["--z-star-m", "0"], "--z-star-m: found 0"), (["--name", "a/b"], "--name: found"),
                        (["--camera", "hand"], "camera: found hand")):
        assert main([*add, *more]) == 2
        assert begin in capsys.readouterr().err
    (folder / "my_arm").mkdir()
    (folder / "my_arm" / "scenario.yaml").write_text("mine")
    assert main(add) == 2 and (folder / "my_arm" / "scenario.yaml").read_text() == "mine"
