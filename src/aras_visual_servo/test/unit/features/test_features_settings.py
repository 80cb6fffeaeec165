"""Features with settings of their own."""

from dataclasses import dataclass

import pytest
from bench import config

from aras_visual_servo import (
    Feature, FeatureSet, ParameterError, register_family, register_feature, ServoSettings, setting)
from aras_visual_servo.features import base
from aras_visual_servo.features.base import feature_settings


@dataclass(frozen=True)
class PowerSettings:
    """Exponent of the powers."""

    exponent: float = setting(2.0, at_least=1, help="Of the depth.")


@dataclass(frozen=True)
class BandSettings:
    """Bands."""

    width: float = setting(above=0, help="Of each band.")


@pytest.fixture(autouse=True)
def features():
    @register_feature("power", settings=PowerSettings)
    class Power(Feature):
        def value(self, view):
            return view ** self.settings.exponent

    @register_family("band", settings=BandSettings)
    class Band(Feature):
        def value(self, view):
            return self.number * self.settings.width * view

    yield
    base.FEATURES.pop("power")
    base.FAMILIES.pop("band")


def test_a_feature_finds_its_settings_or_their_defaults():
    assert FeatureSet(("power",)).values(3.0) == (9.0,)
    assert FeatureSet(("power",), {"power": PowerSettings(3.0)}).values(3.0) == (27.0,)
    assert feature_settings() == {"band": BandSettings, "power": PowerSettings}


def test_a_family_has_one_section_for_all_its_members():
    assert FeatureSet(("band1", "band3"), {"band": BandSettings(0.5)}).values(4.0) == (2.0, 6.0)
    with pytest.raises(ParameterError, match="band: found nothing, .*width"):
        FeatureSet(("band2",))


def test_they_are_read_from_the_section_of_their_name_and_checked():
    names = ["power", "band1"]
    section = config(law="ibvs", features=names, gains_per_s=dict.fromkeys(names, 1.0),
                     thresholds=dict.fromkeys(names, 1.0), power={"exponent": 3}, band={"width": 0.25})
    settings = ServoSettings.from_dict(section).settings
    assert (settings["power"], settings["band"]) == (PowerSettings(3.0), BandSettings(0.25))
    with pytest.raises(ParameterError) as caught:
        ServoSettings.from_dict({**section, "power": {"exponent": 0}, "band": {"height": 1}})
    assert sorted(fault.split(", ")[0] for fault in caught.value.faults) == [
        "servo.band.height: found an unknown key", "servo.band.width: found nothing", "servo.power.exponent: found 0"]
