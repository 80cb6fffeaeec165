"""Where features come from: what servo, loop, nodes and bags ask a source, and one that is a file of its own."""

from types import SimpleNamespace

import numpy as np
import pytest
from bench import Bench, config
from toy_plant import arm, GOAL

from aras_visual_servo import (
    Feature, Features, FeatureSet, known_sources, load_scenario, Observation, ParameterError, register_feature,
    register_source, resolve_uri, Servo, Source, source_named, Status, Taught)
from aras_visual_servo.features import base as features
from aras_visual_servo.features.sources import base as sources
from aras_visual_servo.scenario.check import check
from aras_visual_servo_controller.bags.record_groups import group_of

INFO = {"width": 160, "height": 120, "K": [100.0, 0, 79.5, 0, 100.0, 59.5, 0, 0, 1], "D": [0.0] * 5,
        "distortion_model": "plumb_bob"}
OWN = [source for source in known_sources() if not source.from_elsewhere]
VISION = {"object": "dark", "segmentation": "coverage", "photometric": {"levels": 2}, "matches": {},
          "tag": {"size_m": 0.16}}


def textured_wedge():
    u, v = np.meshgrid(np.arange(160), np.arange(120))
    image = np.rint(215 + 15 * np.sin(0.2 * u + 0.1 * v))
    image += 25 * (np.random.default_rng(1).random((15, 20)).repeat(8, axis=0).repeat(8, axis=1) - 0.5)  # corners
    image = np.rint(image).astype(np.uint8)
    for row in range(30):
        image[40 + row, 50:50 + 2 * (row + 1)] = 20
    return image


def wedges():
    """Images of an asymmetric object: 2 px from the right border, in the middle where it turns, cut by the border."""
    u, v = np.meshgrid(np.arange(160.0), np.arange(120.0))

    def wedge(x, angle=0.0):
        along = (u - x) * np.cos(angle) + (v - 60) * np.sin(angle)
        across = (v - 60) * np.cos(angle) - (u - x) * np.sin(angle)
        return np.where((np.abs(along) < 24) & (np.abs(across) < 0.3 * (along + 30)), 20, 215).astype(np.uint8)

    return [wedge(134), *(wedge(80, angle) for angle in np.arange(0.3, 4.5, 0.4)), wedge(145)]


def test_an_extractor_of_moments_that_is_renewed_is_as_new():
    pytest.importorskip("aras_visual_servo_camera")
    source, vision = source_named("moments"), {**VISION, "border_margin_px": 3}

    def look(extractor):
        """Features of the images, the second of which is taught."""
        seen = []
        for stamp, image in enumerate(wedges()):
            seen.append(Features.from_object(extractor.process(image, stamp)))
            if stamp == 1:
                extractor.teach(stamp, 0.5)
        return seen

    used = source.extractor(INFO, vision)
    new, again = look(used), look(used)
    assert not new[0].touches_border and again[0].touches_border  # it remembers that the object was cut ...
    assert not new[0].has_reference and again[0].has_reference    # ... and what was taught
    renewed = source.renewed(used)
    assert renewed is used and repr(look(renewed)) == repr(new)


def test_an_unknown_source_lists_the_known_ones():
    assert [source.name for source in known_sources() if not source.from_elsewhere] == [
        "matches", "moments", "photometric", "tag"]
    with pytest.raises(ParameterError, match="found sonar, .*matches, moments, .*photometric, .*tag"):
        source_named("sonar")


def view_for(source):
    """An image in which this source finds what it works on."""
    image = textured_wedge()
    if source.name == "tag":
        import matplotlib.image
        tag = matplotlib.image.imread(str(resolve_uri("package://aras_description/targets/tag.png")))
        image[:100, :100] = np.rint(255.0 * tag[::4, ::4])
    return image


@pytest.mark.parametrize("source", OWN, ids=lambda source: source.name)
def test_a_message_has_the_fields_of_what_the_source_makes_in_process(source):
    pytest.importorskip("aras_visual_servo_camera")
    message = pytest.importorskip("roslib.message").get_message_class(source.message)
    seen = source.extractor(INFO, VISION).process(view_for(source), 5)
    assert {name for name in dir(seen) if not name.startswith("_")} == set(message.__slots__) - {"header", "age_s"}
    assert set(source.tell_reference) <= set(message.__slots__)
    assert source.why_lost(seen) == "" and group_of("/a/" + source.topic, "/a/") == "features"


@pytest.mark.parametrize("source", OWN, ids=lambda source: source.name)
def test_a_taught_view_has_the_values_that_the_camera_gives_it_once_it_is_the_reference(source):
    """Bit for bit: the camera need not be asked for them."""
    pytest.importorskip("aras_visual_servo_camera")
    extractor = source.extractor(INFO, VISION)
    seen = extractor.process(view_for(source), 5)
    extractor.teach(5, 0.59)
    again = extractor.process(view_for(source), 6)
    taught = source.taught(seen, 0.59, (0.0, 0.0, 1.0))
    names = {"moments": ("xn", "yn", "an", "alpha"), "photometric": ("photometric",),
             "matches": ("points4", "xm1", "l2", "xr", "tz"), "tag": ("points4", "xm1", "l2", "xr", "tz")}[source.name]
    values = [FeatureSet(names, source=source.name).values(features.View(each)) for each in (taught.features, again)]
    assert values[0] == values[1] and np.isfinite(values[0]).all()


@pytest.mark.parametrize("change, text", [
    ({"target_visible": False, "valid": False}, "target not in view"), ({"valid": False}, "cut by the border"),
    ({"valid": False, "ambiguous": True}, "several objects")])
def test_moments_say_why_they_are_not_fit(change, text):
    seen = SimpleNamespace(**{"target_visible": True, "valid": True, **change})
    assert text in source_named("moments").why_lost(seen)


@pytest.mark.parametrize("change, text", [
    ({"valid": False, "fault": "six motions look alike"}, "six motions look alike"),
    ({"target_visible": False, "valid": False, "fault": ""}, "target not in view"),
    ({"valid": False, "fault": ""}, "features not valid")])
def test_luminance_says_why_it_is_not_fit(change, text):
    seen = SimpleNamespace(**{"target_visible": True, "valid": True, "fault": "", **change})
    assert source_named("photometric").why_lost(seen) == text


def test_views_of_a_goal_are_averaged_field_by_field_and_alpha_the_short_way_round():
    points = ("point_x", "point_y", "ray_x", "ray_y", "ray_z", "kernel_x", "kernel_y")
    numbers = ("area", "xg", "yg", "xn", "yn", "an")
    views = [Features(alpha=alpha, moment_names=("00", "10"), m=(k, 3.0 * k), mu=(2.0 * k, 0.0), point_z=z,
                      **{name: (k, -k) for name in points}, **{name: k + i for i, name in enumerate(numbers)})
             for k, alpha, z in ((1.0, 1.5, (0.5, np.nan)), (2.0, -1.5, (0.4, 0.6)))]
    mean = source_named("moments").mean(views)
    assert (mean.moment_names, mean.m, mean.mu, mean.point_z) == (("00", "10"), (1.5, 4.5), (3.0, 0.0), (0.4, 0.6))
    assert {getattr(mean, name) for name in points} == {(1.5, -1.5)}
    assert [getattr(mean, name) for name in numbers] == [1.5 + i for i in range(6)]
    assert mean.alpha == pytest.approx(0.5 * np.pi)  # 1.5 and 0.142 further on, where an axis is at -1.5 too


@pytest.fixture
def sonar():
    """A source and its feature as a plugin registers them."""

    @register_source("sonar")
    class Sonar(Source):
        topic, message, section = "camera/sonar", "std_msgs/Float64MultiArray", "kernel"

        def taught(self, seen, z_star_m, normal_C):
            return Taught(SimpleNamespace(echo=z_star_m))

    @register_feature("echo")
    class Echo(Feature):
        source = "sonar"

        def value(self, view):
            return view.features.echo

        def row(self, view):
            return np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])

    yield
    sources.SOURCES.pop("sonar")
    features.FEATURES.pop("echo")


def test_a_source_of_somebody_else_is_taught_and_servoed_on(sonar):
    servo = Servo(arm(), config(law="ibvs", features=["echo"], gains_per_s={"echo": 1.0}, thresholds={"echo": 1e-3},
                                interaction="current"))
    assert servo.source.topic == "camera/sonar"
    assert servo.source.kept("seen") == "seen" and servo.source.mean(["first", "second"]) == "first"
    bench, seen = Bench(), SimpleNamespace(target_visible=True, valid=True, echo=3.0)
    reference = servo.teach(seen, GOAL, 0.6)
    assert reference.s_star.tolist() == [0.6] and reference.view is None
    servo.start(0)
    seen.valid = False
    _, record = servo.step(Observation(33_333_333, seen, bench.goal_q), 1 / 30)
    assert (record.status, record.status_text) == (Status.TARGET_LOST, "features not valid")


def test_a_scenario_names_the_section_that_its_source_needs(sonar):
    document = load_scenario("experiment_1").as_dict()
    document["servo"].update(law="ibvs", features=["echo"], gains_per_s={"echo": 1.0}, thresholds={"echo": 1.0})
    assert [fault.path for fault in check(document)] == [("vision", "kernel")]
    document["vision"]["kernel"] = {"p": 1.0, "q": 1.0}
    assert check(document) == []
