"""Features that another node makes: poses, corners and boxes bring the camera home, and what is not fit is named."""

from types import SimpleNamespace as Plain

import numpy as np
import pytest
from views import exponential, tilted_pose

from aras_visual_servo import FeatureSet, load_scenario, Look, ParameterError, Reference, ServoLoop, source_named, View
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.spatial import inverse, quaternion_xyzw

POSE = ("tx", "ty", "tz", "rx", "ry", "rz")
#: A pose goes through quaternion and image points, and back: some digits of double precision.
ROUNDING = 1e-9
SQUARE = np.array([[-0.1, -0.08, 0.0], [0.1, -0.06, 0.0], [0.08, 0.09, 0.0], [-0.07, 0.05, 0.0]])
F, CX, CY = 200.0, 160.0, 120.0


def normalised(pixels):
    return (np.array(pixels) - [CX, CY]) / F, ""


CAMERA = Plain(frame_id="camera", normalised=normalised)


def stamped(frame_id="camera", **fields):
    return Plain(header=Plain(frame_id=frame_id), **fields)


def pose_of(X_WC, T=np.eye(4)):
    X_CT = inverse(X_WC) @ T
    return Plain(position=Plain(**dict(zip("xyz", X_CT[:3, 3]))),
                 orientation=Plain(**dict(zip("xyzw", quaternion_xyzw(X_CT[:3, :3])))))


def corners_of(X_WC, depths=False):
    P = (inverse(X_WC) @ np.c_[SQUARE, np.ones(4)].T)[:3]
    return stamped(polygon=Plain(points=[Plain(x=CX + F * x / z, y=CY + F * y / z, z=z if depths else 0.0)
                                         for x, y, z in P.T]))


def box(u=160.0, v=120.0, width=40.0, height=20.0, score=0.9):
    return Plain(bbox=Plain(center=Plain(x=u, y=v, theta=0.0), size_x=width, size_y=height),
                 results=[Plain(id=1, score=score)])


def servo_home(name, message_of, seen_from):
    """Where pbvs or ibvs ends that was taught at one pose, with messages of another node alone, from 10 cm off."""
    source, goal = source_named(name), tilted_pose(1)
    taught = source.taught(source.read(message_of(goal), CAMERA, None), 0.6, (0.0, 0.0, 1.0))
    law = make_law("pbvs", [2.0] * 6, LawSetup(POSE, pose_from=seen_from))
    features = FeatureSet(POSE, source=name)
    law.reset(Reference(np.array(features.values(View(taught.features))), view=taught.view, plane_C=taught.plane_C))
    X = goal @ exponential([0.1, -0.05, -0.1, 0.2, -0.15, 0.5], 1.0)
    first = law.step(Look(View(source.read(message_of(X), CAMERA, None)), 0.0, np.eye(4)))
    for _ in range(300):
        view = source.read(message_of(X), CAMERA, None)
        assert not source.why_lost(view)
        X = X @ exponential(law.step(Look(View(view), 1.0 / 30.0, np.eye(4))).twist, 1.0 / 30.0)
    return goal, X, first


@pytest.mark.parametrize("name, message_of", [
    ("pose", lambda X: stamped(pose=pose_of(X))),
    ("pose_with_covariance", lambda X: stamped(pose=Plain(pose=pose_of(X), covariance=[1e-6] * 36)))])
def test_a_pose_of_another_node_brings_the_camera_home(name, message_of):
    goal, X, first = servo_home(name, message_of, "points")
    np.testing.assert_allclose(first.s[:3], (exponential([0.1, -0.05, -0.1, 0.2, -0.15, 0.5], 1.0))[:3, 3], atol=1e-7)
    np.testing.assert_allclose(X, goal, atol=1e-6)


@pytest.mark.parametrize("depths, seen_from", [(True, "depth"), (True, "points")])
def test_corners_in_px_bring_the_camera_home(depths, seen_from):
    if seen_from == "points":
        source, goal = source_named("corners"), tilted_pose(1)
        view = source.read(corners_of(goal), CAMERA, None)
        P = (inverse(goal) @ np.c_[SQUARE, np.ones(4)].T)[:3]
        np.testing.assert_allclose([view.point_x, view.point_y], P[:2] / P[2], atol=ROUNDING)
        assert view.point_z == () and view.depth_fault
    else:
        goal, X, _ = servo_home("corners", lambda X: corners_of(X, depths), seen_from)
        np.testing.assert_allclose(X, goal, atol=1e-6)


def test_the_best_box_is_an_object_whose_depth_its_area_tells():
    source = source_named("detections")
    far, near = (stamped(detections=[box(10.0, 10.0, score=0.1), box(180.0, 110.0, size, 0.5 * size)])
                 for size in (40.0, 80.0))
    taught = source.taught(source.read(near, CAMERA, None), 0.5, (0.0, 0.0, 1.0))
    reference = Reference(np.zeros(3), view=taught.view, plane_C=taught.plane_C)
    names = ("xn", "yn", "an")
    features = FeatureSet(names, source="detections")
    np.testing.assert_allclose(features.values(View(taught.features)), [0.05, -0.025, 0.5], atol=ROUNDING)
    view = source.read(far, CAMERA, reference)
    np.testing.assert_allclose(features.values(View(view)), [0.1, -0.05, 1.0], atol=ROUNDING)
    # Central differences of the box of a rectangle parallel to the image, 1 m away, moved along each axis.
    L = features.matrix(View(view, (0.0, 0.0, 1.0)))

    def at(dx, dy, dz):
        scale = 1.0 / (1.0 - dz)
        return features.values(View(source.read(stamped(detections=[box(
            CX + scale * (20.0 - F * dx), CY + scale * (-10.0 - F * dy), 40.0 * scale, 20.0 * scale)]),
            CAMERA, reference)))

    h = 1e-5
    for axis in np.eye(3):
        difference = (np.array(at(*(h * axis))) - at(*(-h * axis))) / (2.0 * h)
        np.testing.assert_allclose(difference, L[:, :3] @ axis, atol=1e-6)


BAD = Plain(position=Plain(x=0.0, y=0.0, z=0.5), orientation=Plain(x=0.0, y=0.0, z=0.0, w=0.0))
NOWHERE = Plain(position=Plain(x=float("nan"), y=0.0, z=0.5), orientation=Plain(x=1.0, y=0.0, z=0.0, w=0.0))
BEHIND = Plain(position=Plain(x=0.0, y=0.0, z=-0.5), orientation=Plain(x=1.0, y=0.0, z=0.0, w=0.0))
GOOD = Plain(position=Plain(x=0.0, y=0.0, z=0.5), orientation=Plain(x=1.0, y=0.0, z=0.0, w=0.0))


@pytest.mark.parametrize("name, message, text", [
    ("pose", stamped(pose=BAD), "unit quaternion"), ("pose", stamped(pose=NOWHERE), "finite position"),
    ("pose", stamped(pose=BEHIND), "behind the camera"),
    ("pose", stamped("base_link", pose=GOOD), "frame 'base_link', allowed .*'camera'"),
    ("pose_with_covariance", stamped(pose=Plain(pose=GOOD, covariance=np.diag([0.01] * 6).ravel())), "0.1 m and 0.1"),
    ("pose_with_covariance", stamped(pose=Plain(pose=GOOD, covariance=np.diag([1e-6] * 5 + [1.0]).ravel())), "1 rad"),
    ("pose_with_covariance", stamped(pose=Plain(pose=GOOD, covariance=[-1.0] * 36)), "variances"),
    ("corners", stamped(polygon=Plain(points=[])), "no points"),
    ("detections", stamped(detections=[]), "no detections"),
    ("detections", stamped(detections=[box(width=0.0)]), "box of 0 x 20 px")])
def test_what_is_not_fit_is_named_and_not_servoed_on(name, message, text):
    import re
    view = source_named(name).read(message, CAMERA, None)
    assert not view.valid and re.search(text, source_named(name).why_lost(view))


def test_a_covariance_of_zeros_is_not_known():
    message = stamped(pose=Plain(pose=GOOD, covariance=[0.0] * 36))
    view = source_named("pose_with_covariance").read(message, CAMERA, None)
    assert view.valid and view.fault == ""


def test_a_run_in_one_process_is_refused():
    pytest.importorskip("aras_visual_servo_camera")
    scenario = load_scenario("six_dof_pbvs", {"servo.source": "pose", "servo.pose_from": "points"})
    with pytest.raises(ParameterError, match="servo.source: found pose, .*over ROS"):
        ServoLoop(scenario)
