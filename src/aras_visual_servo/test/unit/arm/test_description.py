"""Meshes of a vendor's description on a named arm: where they stand, and which descriptions are refused."""
from xml.etree import ElementTree

import numpy as np
import pytest

from aras_visual_servo import Kinematics, ParameterError, load_scenario
from aras_visual_servo.arm.description import with_meshes
from aras_visual_servo.cli.main import main
from aras_visual_servo.spatial import pose_from_rpy


def description(folder, arm="ur5e", mesh="part.stl"):
    """A package ur_description: the base stands elsewhere, the forearm's mesh is on a link that is fixed to it."""
    robot = ElementTree.fromstring(load_scenario(arm).urdf_xml())
    for link in robot.findall("link"):
        for each in link.findall("visual") + link.findall("collision"):
            link.remove(each)
        if link.get("name") in ("shoulder_link", "wrist_2_link", "base_link_inertia"):
            add_mesh(link, mesh)
    base = robot.find("joint[@name='base_joint']/origin")
    if base is not None:
        base.set("xyz", "3 2 1")
    cover = ElementTree.SubElement(robot, "link", name="forearm_cover")
    add_mesh(cover, mesh)
    joint = ElementTree.SubElement(robot, "joint", name="cover_joint", type="fixed")
    ElementTree.SubElement(joint, "origin", xyz="-0.1 0 0.05", rpy="0 0.4 0")
    ElementTree.SubElement(joint, "parent", link=robot.findall("joint")[4].find("child").get("link"))
    ElementTree.SubElement(joint, "child", link="forearm_cover")
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "part.stl").write_text("solid part\nendsolid part\n")
    (folder / "package.xml").write_text("<package><name>ur_description</name></package>")
    (folder / "urdf").mkdir()
    (folder / "urdf" / "arm.urdf").write_text(ElementTree.tostring(robot, encoding="unicode"))
    return folder


def add_mesh(link, mesh):
    visual = ElementTree.SubElement(link, "visual")
    ElementTree.SubElement(visual, "origin", xyz="0.01 0.02 0.03", rpy="0.1 0.2 0.3")
    ElementTree.SubElement(ElementTree.SubElement(visual, "geometry"), "mesh",
                           filename=f"package://ur_description/meshes/{mesh}")


def meshes_of(urdf, q):
    """Poses of the meshes of a URDF at joint positions, in the last link of the wrist."""
    found = []
    for link in ElementTree.fromstring(urdf).findall("link"):
        for visual in link.findall("visual"):
            if visual.find("geometry/mesh") is not None:
                origin = visual.find("origin")
                X = pose_from_rpy(*(np.array(origin.get(key).split(), dtype=float) for key in ("xyz", "rpy")))
                arm = Kinematics(urdf, "wrist_3_link", link.get("name"), upwards=True)
                found.append(arm.pose(arm.vector({name: q[name] for name in arm.joint_names})) @ X)
    return sorted(found, key=lambda X: X[:3, 3].tolist())


def test_every_mesh_moves_as_on_the_vendors_arm(tmp_path):
    folder = description(tmp_path / "somewhere")
    own = load_scenario("ur5e")
    urdf = with_meshes(own.urdf_xml(), str(folder))
    q = dict(zip(own.kinematics().joint_names, (0.3, -1.2, 0.9, 0.4, -0.7, 1.1)))
    there = meshes_of((folder / "urdf" / "arm.urdf").read_text(), q)
    here = meshes_of(urdf, q)
    assert len(here) == len(there) == 4
    np.testing.assert_allclose(here, there, atol=1e-8)
    links = {link.get("name"): link.findall("visual") for link in ElementTree.fromstring(urdf).findall("link")}
    assert len(links["shoulder_link"]) == 1 and len(links["wrist_1_link"]) > 1  # without a mesh it keeps its shapes
    path = links["shoulder_link"][0].find("geometry/mesh").get("filename")
    assert path == str((folder / "meshes" / "part.stl").resolve())


def test_another_arm_and_missing_files_are_named(tmp_path):
    own = load_scenario("ur5e").urdf_xml()
    with pytest.raises(ParameterError) as error:
        with_meshes(own, str(description(tmp_path / "a", "ur10e")))
    assert {fault.split()[3] for fault in error.value.faults} >= {"elbow_joint", "wrist_1_joint"}
    with pytest.raises(ParameterError, match="gone.stl"):
        with_meshes(own, str(description(tmp_path / "b", mesh="gone.stl")))
    with pytest.raises(ParameterError) as error:
        with_meshes(own, str(description(tmp_path / "c", "iiwa7") / "urdf" / "arm.urdf"))
    assert len(error.value.faults) == 6
    (tmp_path / "b" / "urdf" / "other.urdf").write_text("<robot/>")
    with pytest.raises(ParameterError, match="urdf/arm.urdf, urdf/other.urdf"):
        with_meshes(own, str(tmp_path / "b"))


def test_the_word_writes_an_arm_that_goes_under_any_task(tmp_path, monkeypatch):
    folder = description(tmp_path / "ur_description")
    monkeypatch.chdir(tmp_path)
    assert main(["robot", "meshes", "ur5e", "--description", str(folder), "--folder", "mine"]) == 0
    scenario = load_scenario("six_dof_points", {"robot": str(tmp_path / "mine" / "scenario.yaml")})
    assert scenario.controllers_path == tmp_path / "mine" / "controllers.yaml"  # where servo.launch looks for it
    assert "part.stl" in scenario.urdf_xml() and scenario.experiment == load_scenario(
        "six_dof_points", {"robot": "ur5e"}).experiment
    assert main(["robot", "meshes", "ur5e", "--description", str(folder), "--folder", "mine"]) == 2
