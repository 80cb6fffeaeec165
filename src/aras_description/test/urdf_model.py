"""What the tests need of a URDF: the tree, link inertias, forward kinematics, mesh files. No ROS."""

import pathlib
import xml.etree.ElementTree as ElementTree

import numpy as np

PACKAGE = pathlib.Path(__file__).resolve().parent.parent


def vector(text, default="0 0 0"):
    """Three numbers of an attribute, shape (3,)."""
    return np.array([float(word) for word in (text or default).split()])


def rotation(axis, angle):
    """Rodrigues' formula: rotation by angle [rad] about a unit axis, shape (3, 3)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def pose(rotation_matrix, position):
    """Homogeneous 4 x 4 matrix."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation_matrix, position
    return matrix


def origin(element):
    """Pose of an element's <origin>, shape (4, 4): fixed-axis roll, pitch, yaw as URDF defines it."""
    tag = element.find("origin")
    if tag is None:
        return np.eye(4)
    roll, pitch, yaw = vector(tag.get("rpy"))
    x, y, z = np.eye(3)
    return pose(rotation(z, yaw) @ rotation(y, pitch) @ rotation(x, roll), vector(tag.get("xyz")))


def stl_triangles(path):
    """Corners of a binary STL file's triangles, shape (n, 3, 3) [m]; ValueError when the size and count disagree."""
    content = path.read_bytes()
    record = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
    count = int(np.frombuffer(content, "<u4", 1, offset=80)[0])
    if len(content) != 84 + count * record.itemsize:
        raise ValueError(f"{path.name}: {len(content)} bytes for {count} triangles")
    return np.frombuffer(content, record, offset=84)["points"].astype(float)


class UrdfModel:
    """Links and joints by name."""

    def __init__(self, path):
        self.root = ElementTree.parse(path).getroot()
        self.links = {link.get("name"): link for link in self.root.findall("link")}
        self.joints = {joint.get("name"): joint for joint in self.root.findall("joint")}
        self.parent_joint = {joint.find("child").get("link"): joint for joint in self.joints.values()}

    def limit(self, joint):
        """Limit attributes of a joint as numbers."""
        return {key: float(value) for key, value in self.joints[joint].find("limit").attrib.items()}

    def inertial(self, link):
        """(mass [kg], centre of mass (3,) [m], inertia about it (3, 3) [kg m^2]) in the link frame, or None."""
        tag = self.links[link].find("inertial")
        if tag is None:
            return None
        ixx, ixy, ixz, iyy, iyz, izz = (float(tag.find("inertia").get(key))
                                        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        frame = origin(tag)
        inertia = frame[:3, :3] @ np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) @ frame[:3, :3].T
        return float(tag.find("mass").get("value")), frame[:3, 3], inertia

    def mesh_files(self, link=None):
        """Names package://... of the meshes of one link or of all."""
        element = self.root if link is None else self.links[link]
        return [mesh.get("filename") for mesh in element.iter("mesh")]

    def link_pose(self, link, positions):
        """X_WL, shape (4, 4), with the root at W; joints not in positions [m, rad] are at 0."""
        matrix = np.eye(4)
        while link in self.parent_joint:
            joint = self.parent_joint[link]
            motion = np.eye(4)
            if joint.get("type") != "fixed":
                axis, q = vector(joint.find("axis").get("xyz")), positions.get(joint.get("name"), 0.0)
                prismatic = joint.get("type") == "prismatic"
                motion = pose(np.eye(3), axis * q) if prismatic else pose(rotation(axis, q), np.zeros(3))
            matrix = origin(joint) @ motion @ matrix
            link = joint.find("parent").get("link")
        return matrix
