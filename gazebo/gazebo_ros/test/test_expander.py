"""The reader that takes libsdformat's place where there is none: the same worlds, and what it lacks is said."""
import os
import xml.etree.ElementTree as ElementTree

import pytest

from aras_visual_servo_sim import ModelError

from gazebo_ros.sdf import expander, mend
from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.world import read_world

OWN_MODELS = os.path.join(os.path.dirname(__file__), os.pardir, "models")
ARM = """<model name='arm'><pose>1 2 0.5 0.1 0.2 0.3</pose><link name='base'>
  <inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.3</izz></inertia></inertial></link>
  <link name='tip'><pose>0 0 1 0 0.4 0</pose>
  <visual name='v'><geometry><mesh><uri>%s/tip.obj</uri><scale>2 2 2</scale></mesh></geometry></visual>
  <collision name='c'><geometry><cylinder><radius>0.1</radius><length>0.5</length></cylinder></geometry></collision>
  </link>
  <joint name='j' type='revolute'><parent>base</parent><child>tip</child><axis>%s<xyz>0 0 1</xyz>
  <limit><lower>-1</lower><upper>1.5</upper><effort>7</effort></limit></axis></joint></model>"""
MODEL_FRAME = "<use_parent_model_frame>1</use_parent_model_frame>"


class Folders(NoFolders):
    """One folder of models."""

    def __init__(self, folder):
        self._folder = folder

    def __call__(self, name):
        place = os.path.join(str(self._folder), name)
        return place if os.path.isdir(place) else None


@pytest.fixture(name="models")
def models_fixture(tmp_path):
    """A model whose mesh has a path of its own, and one that includes it."""
    (tmp_path / "tip.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name, version, text in (("arm", "1.6", ARM % (tmp_path, "")),
                                ("cell", "1.7", "<model name='cell'><link name='floor'/><include><uri>model://arm</uri>"
                                 "<name>left</name><pose>0 1 0 0 0 0</pose></include></model>")):
        (tmp_path / name).mkdir()
        config = "<model><name>%s</name><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>model.sdf</sdf></model>"
        (tmp_path / name / "model.config").write_text(config % name)
        (tmp_path / name / "model.sdf").write_text("<sdf version='%s'>%s</sdf>" % (version, text))
    return tmp_path


def said(file):
    """What a world file says of its models, as far as it does not depend on defaults of the specification."""
    models = []
    for model, pose in file.models:
        robot = ElementTree.fromstring(model.urdf)
        parts = [ElementTree.tostring(each) for each in robot if each.tag in ("link", "joint")]
        models.append((model.name, parts, pose.round(9).tolist()))
    return models, file.settings, file.update_rate_hz, list(file.lights), file.ground_at


@pytest.mark.parametrize("version, text", [
    ("1.6", "<include><uri>model://arm</uri></include>"),
    ("1.6", "<include><uri>model://arm</uri><name>mine</name><static>1</static><pose>0 0 3 0 0 1</pose></include>"),
    ("1.6", ARM % ("", MODEL_FRAME)), ("1.5", ARM % ("", "")), ("1.4", ARM % ("", "")), ("1.9", ARM % ("", "")),
    ("1.5", "<physics type='ode'><gravity>0 0 -3</gravity><max_step_size>0.002</max_step_size></physics>"),
    ("1.3", "<physics type='ode'><update_rate>500</update_rate><ode><solver><dt>0.004</dt></solver></ode></physics>"),
    ("1.6", "<light name='lamp' type='point'/><model name='a'><link name='l'><pose>0 0</pose></link></model>"),
    ("1.6", "<model name='a'><link name='l'/><link name='m'><pose frame='l'>1 0 0 0 0 0</pose></link></model>")])
def test_worlds_are_those_that_libsdformat_reads(version, text, models, monkeypatch):
    binding = pytest.importorskip("gazebo_ros._sdf", reason="there is no libsdformat to compare with")
    files = []
    for reader in (binding, expander):
        monkeypatch.setattr(mend, "_sdf", reader)
        files.append(read_world("<sdf version='%s'><world name='w'>%s</world></sdf>" % (version, text), False,
                                Folders(models)))
    assert said(files[0]) == said(files[1])
    assert [bool(file.warnings) for file in files] == [bool(files[0].warnings)] * 2


@pytest.mark.parametrize("text, words", [
    ("<sdf version='1.2'/>", ("1.2", "1.3")), ("<robot name='r'><link name='l'/></robot>", ("<robot>", "<sdf>"))])
def test_what_it_does_not_read_is_refused_by_name(text, words, tmp_path, monkeypatch):
    monkeypatch.setattr(mend, "_sdf", expander)
    (tmp_path / "w.world").write_text(text)
    with pytest.raises(ModelError) as caught:
        read_world(str(tmp_path / "w.world"), True, NoFolders())
    assert all(word in str(caught.value) for word in (*words, "w.world", "libsdformat"))


def test_a_model_that_includes_itself_ends_there(models, monkeypatch):
    monkeypatch.setattr(mend, "_sdf", expander)
    (models / "cell" / "model.sdf").write_text("<sdf version='1.6'><model name='cell'><link name='l'/><include>"
                                               "<uri>model://cell</uri></include></model></sdf>")
    file = read_world("<sdf version='1.6'><world name='w'><include><uri>model://cell</uri></include></world></sdf>",
                      False, Folders(models))
    assert [model.name for model, _ in file.models] == ["cell"]
    assert any("includes itself" in line for line in file.warnings)


def test_a_model_keeps_what_it_includes(models, monkeypatch):
    # libsdformat 12 loses it in an included model.
    monkeypatch.setattr(mend, "_sdf", expander)
    file = read_world("<sdf version='1.6'><world name='w'><include><uri>model://cell</uri></include></world></sdf>",
                      False, Folders(models))
    links = [link.get("name") for model, _ in file.models for link in ElementTree.fromstring(model.urdf).iter("link")]
    assert {"floor", "left::base", "left::tip"} <= set(links)
