"""Named arms: the URDF is that of the table, every value has a source, and the kinematics are the published ones."""

import importlib
import sys

import numpy as np
import pytest
import yaml

from urdf_model import PACKAGE, UrdfModel

sys.path.insert(0, str(PACKAGE / "scripts"))
make_arms = importlib.import_module("make_arms")

TABLES = {path.parent.name: yaml.safe_load(path.read_text())
          for path in sorted((PACKAGE / "arms").glob("*/table.yaml"))}
#: What a table has figures of.
SOURCED = ("joints", "limits", "masses", "com", "inertia", "camera")
arms = pytest.mark.parametrize("name", TABLES)


def urdf(name):
    return PACKAGE / "arms" / name / "arm.urdf"


def published(dh, q):
    """Pose of the tip in the base by Denavit-Hartenberg parameters, joints in their order, shape (4, 4)."""
    q, X = list(q), np.eye(4)
    for i, (a, alpha_deg, d, theta_deg) in enumerate(dh["rows"]):
        moves = q and not (i == 0 and dh.get("fixed_first"))
        theta, alpha = np.radians(theta_deg) + (q.pop(0) if moves else 0.0), np.radians(alpha_deg)
        z, x = np.eye(4), np.eye(4)
        z[:3, :3], z[2, 3] = make_arms.rotation(0.0, 0.0, theta), d
        x[:3, :3], x[0, 3] = make_arms.rotation(alpha, 0.0, 0.0), a
        X = X @ (z @ x if dh["convention"] == "standard" else x @ z)
    return X


@arms
def test_forward_kinematics_are_those_of_the_published_parameters(name):
    table, model = TABLES[name], UrdfModel(urdf(name))
    moving = [joint for joint, entry in table["joints"].items() if "limits" in entry]
    if "dh" not in table:  # no table is published: the lengths between the axes are
        for upper, lower, length in (("upper_arm", "lower_arm", 0.1160), ("lower_arm", "wrist", 0.1350)):
            way = model.link_pose(lower, {})[:3, 3] - model.link_pose(upper, {})[:3, 3]
            assert np.linalg.norm(way) == pytest.approx(length, abs=5e-5)
        return
    dh, rng = table["dh"], np.random.default_rng(5)
    for q in rng.uniform(-2.0, 2.0, (20, len(moving))):
        joints = dict(zip(moving, q))
        X = np.linalg.solve(model.link_pose(dh["base"], joints), model.link_pose(dh["tip"], joints))
        np.testing.assert_allclose(X, published(dh, q), atol=dh["tolerance_m"])


@arms
def test_the_urdf_is_made_of_the_table(name):
    assert make_arms.urdf(TABLES[name]) == urdf(name).read_text()
    model, unit = UrdfModel(urdf(name)), np.pi / 180 if TABLES[name]["angles"] == "deg" else 1.0
    for joint, entry in TABLES[name]["joints"].items():
        if "limits" in entry:
            lower, upper, velocity, effort = entry["limits"]
            expected = {"velocity": velocity * unit, "effort": effort}
            expected.update({} if lower is None else {"lower": lower * unit, "upper": upper * unit})
            assert model.limit(joint) == pytest.approx(expected)
    for link, entry in TABLES[name]["links"].items():
        if "mass" in entry:
            mass, com, inertia = model.inertial(link)
            assert mass == pytest.approx(entry["mass"]) and com == pytest.approx(entry["com"])
            a, b, c = np.linalg.eigvalsh(inertia)
            assert 0.0 < a and c < a + b


@arms
def test_every_figure_has_a_source(name):
    said = {word.strip() for key, text in TABLES[name]["sources"].items() if text for word in key.split(",")}
    assert set(SOURCED) <= said and ("dh" in said) == ("dh" in TABLES[name])
    assert TABLES[name]["driver"]["controller"].startswith("/") and TABLES[name]["driver"]["package"]


def test_a_rotation_survives_its_angles():
    for rpy in ((0.3, -0.2, 2.0), (0.4, np.pi / 2, 1.0), (0.0, -np.pi / 2, 0.0)):
        R = make_arms.rotation(*rpy)
        np.testing.assert_allclose(make_arms.rotation(*make_arms.rpy_of(R)), R, atol=1e-12)
