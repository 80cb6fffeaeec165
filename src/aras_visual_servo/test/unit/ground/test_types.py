"""Containers keep the names and codes of the messages."""

from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from aras_visual_servo import Features, ParameterError, Reference, ServoRecord, Status

MESSAGES = Path(__file__).parents[4] / "aras_visual_servo_msgs" / "msg"


def message_lines(name):
    lines = [line.split("#")[0].split() for line in (MESSAGES / f"{name}.msg").read_text().splitlines()]
    return [line for line in lines if len(line) == 2]


def test_status_codes_are_those_of_the_message():
    constants = dict(line[1].split("=") for line in message_lines("ServoState") if "=" in line[1])
    assert {name: int(value) for name, value in constants.items()} == {status.name: status.value for status in Status}


@pytest.mark.parametrize("message, container, extra", [
    ("MomentFeatures", Features, set()),
    ("ServoState", ServoRecord, {"stamp_ns"}),
])  # fmt: skip
def test_container_has_the_fields_of_its_message(message, container, extra):
    names = {line[1] for line in message_lines(message) if "=" not in line[1]} - {"header"}
    assert {field.name for field in fields(container)} == names | extra


def test_features_copy_any_object_and_give_moments_by_name():
    source = SimpleNamespace(**{field.name: () if field.default == () else 0.0 for field in fields(Features)
                                if field.name != "age_s"})
    source.moment_names, source.m, source.mu = ["00", "10"], [2.0, 3.0], [2.0, 0.0]
    source.point_x, source.point_y = [0.1, 0.2], [0.3, 0.4]
    source.kernel_x, source.kernel_y = [1.0], [2.0]
    copy = Features.from_object(source)
    source.m[0] = source.point_x[0] = 9.0
    assert copy.raw_moments() == {"00": 2.0, "10": 3.0}
    assert copy.centred_moments() == {"00": 2.0, "10": 0.0}
    assert copy.point_x == (0.1, 0.2) and copy.point_y == (0.3, 0.4)


def test_reference_round_trip():
    reference = Reference(np.array([0.1, 0.2, 0.6, -1.0]), np.array([0.0, 0.0, -1.0]), {"J1": 0.5})
    back = Reference.from_dict(reference.to_dict())
    np.testing.assert_array_equal(back.s_star, reference.s_star)
    np.testing.assert_array_equal(back.optical_axis_B, reference.optical_axis_B)
    assert back.posture == reference.posture


def test_reference_without_attitude_round_trip():
    back = Reference.from_dict(Reference(np.zeros(4)).to_dict())
    assert back.optical_axis_B is None and back.posture is None


def test_reference_lists_every_fault():
    bad = {"s_star": [0.0, np.nan], "optical_axis_B": [0.0, np.nan, 1.0], "posture": 5, "more": 1}
    with pytest.raises(ParameterError) as caught:
        Reference.from_dict(bad)
    assert len(caught.value.faults) == 4
