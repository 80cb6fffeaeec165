"""The messages in gazebo/ are wire-compatible with those that Gazebo-era nodes were built with."""
import pathlib

import genmsg.gentools
import genmsg.msg_loader
import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2] / "gazebo"
PUBLISHED = yaml.safe_load((pathlib.Path(__file__).parent / "md5_sums.yaml").read_text())
PACKAGES = ("gazebo_msgs", "control_msgs", "controller_manager_msgs")
SHARE = pathlib.Path("/usr/share")
#: What actionlib makes of the parts of an action, by suffix.
WRAPPED = {
    "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback\n",
    "ActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\n{0}Goal goal\n",
    "ActionResult": "Header header\nactionlib_msgs/GoalStatus status\n{0}Result result\n",
    "ActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\n{0}Feedback feedback\n"}


def definitions():
    """(name, text, whether it is a service) of every message of the three packages, parts of actions included."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).glob("msg/*.msg")):
            yield f"{package}/{path.stem}", path.read_text(), False
        for path in sorted((ROOT / package).glob("srv/*.srv")):
            yield f"{package}/{path.stem}", path.read_text(), True
        for path in sorted((ROOT / package).glob("action/*.action")):
            parts = dict(zip(("Goal", "Result", "Feedback"), path.read_text().split("---\n")))
            parts.update((suffix, text.format(path.stem)) for suffix, text in WRAPPED.items())
            for suffix, text in parts.items():
                yield f"{package}/{path.stem}{suffix}", text, False


@pytest.fixture(scope="module")
def sums(tmp_path_factory):
    """MD5 sum of each message of gazebo/, by name."""
    folder = tmp_path_factory.mktemp("messages")
    search = {path.name: [str(path / "msg")] for path in SHARE.glob("*_msgs")}
    search.update({package: [str(folder / package)] for package in PACKAGES})
    found = list(definitions())
    for name, text, is_service in found:
        path = folder / f"{name}.{'srv' if is_service else 'msg'}"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    made = {}
    for name, text, is_service in found:
        context = genmsg.msg_loader.MsgContext.create_default()
        if is_service:
            spec = genmsg.msg_loader.load_srv_from_string(context, text, name)
            parts = (spec.request, spec.response)
        else:
            spec = genmsg.msg_loader.load_msg_from_string(context, text, name)
            parts = (spec,)
        for part in parts:
            genmsg.msg_loader.load_depends(context, part, search)
        made[name] = genmsg.gentools.compute_md5(context, spec)
    return made


def test_every_sum_is_the_published_one(sums):
    assert sums == PUBLISHED


def test_a_field_of_another_type_changes_the_sum(sums):
    """The check sees what it is for."""
    text = (ROOT / "control_msgs" / "msg" / "GripperCommand.msg").read_text()
    context = genmsg.msg_loader.MsgContext.create_default()
    changed = genmsg.msg_loader.load_msg_from_string(context, text.replace("float64 max_effort", "float32 max_effort"),
                                                     "control_msgs/GripperCommand")
    assert genmsg.gentools.compute_md5(context, changed) != sums["control_msgs/GripperCommand"]
