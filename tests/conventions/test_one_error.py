"""All bindings raise the same Python classes, so that one `except ArasError` catches them all."""
import numpy as np
import pytest

aras_visual_servo = pytest.importorskip("aras_visual_servo")
aras_visual_servo_camera = pytest.importorskip("aras_visual_servo_camera")
aras_visual_servo_common = pytest.importorskip("aras_visual_servo_common")
aras_visual_servo_sim = pytest.importorskip("aras_visual_servo_sim")
CAMERA = {"width": 64, "height": 48, "K": [60, 0, 32, 0, 60, 24, 0, 0, 1], "D": [], "distortion_model": "none"}


def of_the_simulator():
    aras_visual_servo_sim.Simulation("<robot", {})


def of_a_section():
    aras_visual_servo_camera.MomentExtractor(CAMERA, {"object": "drak", "orders": None})


def of_an_image():
    aras_visual_servo_camera.TagExtractor(CAMERA).process(np.zeros((2, 3, 5), np.uint8))


def of_the_kinematics():
    from aras_visual_servo import _kinematics
    _kinematics.ChainKinematics("<robot", "a", "b")


@pytest.mark.parametrize("action, name", [(of_the_simulator, "ModelError"), (of_a_section, "ParameterError"),
                                          (of_an_image, "ShapeError"), (of_the_kinematics, "ModelError")])
def test_each_binding_raises_the_common_class(action, name):
    with pytest.raises(aras_visual_servo_common.ArasError) as caught:
        action()
    assert type(caught.value) is getattr(aras_visual_servo_common, name)


def test_the_packages_export_the_common_classes():
    for package in (aras_visual_servo, aras_visual_servo_camera, aras_visual_servo_sim):
        assert package.ArasError is aras_visual_servo_common.ArasError
        assert package.ParameterError is aras_visual_servo_common.ParameterError


def test_a_parameter_error_lists_its_faults():
    with pytest.raises(aras_visual_servo_common.ParameterError) as caught:
        of_a_section()
    assert {fault.split(": ")[0] for fault in caught.value.faults} == {"vision.object", "vision.segmentation",
                                                                       "vision.orders"}
    assert all(part in str(caught.value) for part in ("did you mean dark?", "did you mean order?"))
