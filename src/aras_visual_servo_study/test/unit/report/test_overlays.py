"""What features show in the image: for every kind of features in the right place, with a legend, and in the page."""

import json
import re

import numpy as np
import pytest
from browser import CHROMIUM, Browser

pytest.importorskip("cv2")
pytest.importorskip("aras_visual_servo_sim")
from aras_visual_servo.arm.robot import robot_kinematics  # noqa: E402
from aras_visual_servo import styles  # noqa: E402
from aras_visual_servo.features.base import feature_class, known_features  # noqa: E402
from aras_visual_servo_study.report.image_plot import coloured_difference, image_plot  # noqa: E402
from aras_visual_servo_study.report.joint_plot import joint_plot  # noqa: E402
from aras_visual_servo_study.report.overlays import base, overlay_of  # noqa: E402
from aras_visual_servo_study.report.page import report_html  # noqa: E402
from aras_visual_servo_study.report.report import summarise  # noqa: E402
import aras_visual_servo as avs  # noqa: E402
from aras_visual_servo.scenario.scenario import load_scenario  # noqa: E402

#: A scenario of each family of features, and what must be drawn: ways and shapes.
FAMILIES = {
    "experiment_1": ({"centroid"}, {"axis", "circle of the same area"}),
    "six_dof_rectangle": ({"centroid"}, {"axis", "circle of the same area", "outline, by the true pose"}),
    "six_dof_points": ({"point1", "point2", "point3", "point4"}, {"lines between the points"}),
    "six_dof_pbvs": ({"origin of the target"}, {"x of the target", "y of the target", "z of the target",
                                                "outline, by the true pose"}),
    "six_dof_hybrid": ({"reference point", "origin of the target"}, {"ring: larger is nearer"}),
    "six_dof_photometric": ({"corner1", "corner2", "corner3", "corner4"}, {"middle of the goal image"}),
    "kernel": ({"centroid"}, {"weight 1 of kx", "weight 1 of ky", "axis"}),
}
#: A run that has arrived sees its features where they are wanted: a tenth of a millimetre is less than that.
ARRIVED_PX = 1.0
#: Between the outline and the pixels that are dark, whose middles lie up to half a pixel within it.
PIXEL = 0.75


@pytest.fixture(scope="module")
def records():
    return {name: avs.run(load_scenario(name)) for name in FAMILIES}


@pytest.fixture(scope="module", params=FAMILIES)
def shown(request, records):
    return request.param, records[request.param], overlay_of(records[request.param])


def dark(image):
    """u and v of the pixels of a dark object."""
    v, u = np.nonzero(image[..., 0] < 125)
    return u, v


def test_every_feature_has_a_kind_of_overlay_that_is_known(records):
    kinds = {name: feature_class(name.replace("N", "1")).overlay for name in known_features()}
    overlay_of(records["kernel"])  # which loads them
    assert set(kinds.values()) == set(base.OVERLAYS) and "" not in kinds.values()


def test_the_overlay_shows_the_ways_and_shapes_of_its_features(shown):
    name, _, overlay = shown
    ways, shapes = FAMILIES[name]
    assert {way.name + way.subscript for way in overlay.ways} == ways
    assert shapes <= {shape.name for shape in overlay.shapes}
    assert overlay.difference == (name == "six_dof_photometric")


def test_features_move_from_the_start_to_where_they_are_wanted(shown):
    _, _, overlay = shown
    for way in overlay.ways:
        assert np.linalg.norm(way.seen[0] - way.wanted) > 5.0, way.name
        assert np.linalg.norm(way.seen[-1] - way.wanted) < ARRIVED_PX, way.name
    for shape in overlay.shapes:
        if shape.wanted is not None:
            assert np.abs(shape.seen[-1] - shape.wanted).max() < 2 * ARRIVED_PX, shape.name


def test_every_way_and_shape_has_a_legend_and_a_colour_in_the_page(shown):
    name, record, overlay = shown
    figure = re.search(r'<figure class="plot" id="image".*?</figure>', report_html(record, summarise(record)), re.S)[0]
    legend = re.search(r'<div class="legend">(.*?)</div>', figure, re.S)[1]
    entries = {re.sub("<.*?>", "", text): colour
               for colour, text in re.findall(r'--c:(#\w+);[^>]*></span>(.*?)</span>', legend)}
    for way in overlay.ways:
        assert entries[way.name + way.subscript] == way.colour
    for shape in overlay.shapes:
        assert entries[shape.name if shape.wanted is not None else "lines of equal weight"]
        assert f'stroke="{shape.colour}"' in figure
    assert ("■ darker than the goal image" in entries) == overlay.difference
    errors = re.search(r'<figure class="plot" id="errors".*?</figure>', report_html(record, summarise(record)), re.S)[0]
    assert all(f"<span>{style.letter}" in errors for style in styles(record.feature_names))


def test_points_and_outline_lie_on_the_corners_of_the_object(records):
    for name in ("six_dof_points", "six_dof_rectangle"):
        record = records[name]
        overlay = overlay_of(record)
        shape = next(shape for shape in overlay.shapes if len(shape.wanted) == 4)
        for image, corners in ((record.desired_image, shape.wanted), (record.initial_image, shape.seen[0])):
            u, v = dark(image)
            assert np.abs([corners[:, 0].min() - u.min(), corners[:, 0].max() - u.max(), corners[:, 1].min() - v.min(),
                           corners[:, 1].max() - v.max()]).max() < PIXEL + 0.5, name


def test_the_measured_frame_of_the_target_is_that_of_its_true_pose(records):
    overlay, scene = overlay_of(records["six_dof_pbvs"]), base.Scene(records["six_dof_pbvs"])
    true = scene.seen_in(np.zeros((1, 3)), scene.target[0])[:, 0]
    assert np.abs(overlay.ways[0].seen - true).max() < 2.0  # pose from moments of pixels


def test_lines_of_the_kernel_are_where_it_weighs_so(records):
    record = records["kernel"]
    overlay, K = overlay_of(record), record.camera_info["K"]
    begin = (-1.0 - K[2]) / K[0]  # one pixel outside the image, as the camera takes it
    at = {shape.name: (shape.seen[0, 0, 0] - K[2]) / K[0] - begin for shape in overlay.shapes if " of kx" in shape.name}
    power = record.settings["vision"]["kernel"]["p"]
    assert at["weight 2 of kx"] ** -power == pytest.approx(2 * at["weight 1 of kx"] ** -power)
    assert at["weight 0.6 of kx"] ** -power == pytest.approx(0.6 * at["weight 1 of kx"] ** -power)


def test_a_difference_tells_darker_from_brighter():
    desired = np.full((2, 3), 100, np.uint8)
    image = np.array([[100, 0, 255], [100, 0, 255]], np.uint8)
    equal, darker, brighter = coloured_difference(image, desired)[0].astype(int)
    assert equal.min() > 230 and darker[2] > darker[0] + 80 and brighter[0] > brighter[2] + 80


def test_a_record_of_no_camera_and_no_robot_has_no_such_panels(records):
    import dataclasses
    record = dataclasses.replace(records["kernel"], camera_info={}, settings={})
    assert image_plot(record) is None and joint_plot(record) is None


def test_joints_are_drawn_between_their_limits_and_read_off_in_their_units(records):
    record = records["experiment_1"]
    data = json.loads(json.dumps(joint_plot(record)["data"], allow_nan=False))
    scenario = load_scenario("experiment_1")
    arm = robot_kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    assert [one["name"] for one in data["series"]] == list(arm.joint_names) and data["ends"] == [-1.0, 1.0]
    for one, low, high in zip(data["series"], arm.lower, arm.upper):
        q = record.q[record.servo_rows[0], record.joint_names.index(one["name"])]
        read = q * (1e3 if one["name"] == "gantry" else 180.0 / np.pi)
        assert one["y"][0] * one["factor"] + one["offset"] == pytest.approx(read, abs=1e-4)
        assert one["unit"] == ("mm" if one["name"] == "gantry" else "deg")
        if np.isfinite(high):
            assert one["y"][0] == pytest.approx((2 * q - low - high) / (high - low), abs=1e-6) and not one["dash"]
        else:
            assert one["dash"]


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_panel_of_the_image_follows_the_moment(records, tmp_path):
    record = records["six_dof_photometric"]
    (tmp_path / "report.html").write_text(report_html(record, summarise(record)))
    with Browser(tmp_path) as browser:
        browser.open((tmp_path / "report.html").as_uri())
        browser.wait("window.replay && replay.moments")
        dots = ("[...document.querySelectorAll('#image .now .dot')].map((dot) => [Number(dot.getAttribute('cx')), "
                "Number(dot.getAttribute('cy'))])")
        overlay = overlay_of(record)
        assert np.allclose(browser.value(dots), [way.seen[0] for way in overlay.ways], atol=0.06)
        back = "document.querySelector('#image .view').getAttribute('href')"
        before, last = browser.value(back), replay_end(browser)
        browser.value(f"(() => {{ const slider = document.querySelector('#replay-time'); slider.value = {last}; "
                      "slider.dispatchEvent(new Event('input')); })()")
        browser.wait(f"{back} !== {json.dumps(before)}")
        assert np.allclose(browser.value(dots), [way.seen[-1] for way in overlay.ways], atol=0.06)
        # At the goal hardly anything differs: the image has the colour of "equal".
        colour = browser.value(
            "(async () => { const image = new Image(); image.src = " + back + "; await image.decode(); const pen = "
            "Object.assign(document.createElement('canvas'), { width: 32, height: 24 }).getContext('2d'); "
            "pen.drawImage(image, 0, 0, 32, 24); return [...pen.getImageData(0, 0, 32, 24).data]"
            ".filter((_, i) => i % 4 < 3).reduce((a, b) => Math.min(a, b)); })()")
        assert colour > 180
        browser.value("document.querySelector('#image button[data-do=in]').click()")
        assert float(browser.value("document.querySelector('#image svg').getAttribute('viewBox')").split()[2]) < 320
        assert browser.said == []


def replay_end(browser):
    """Number of the last moment of the slider."""
    return int(browser.value("document.querySelector('#replay-time').max"))


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_report_fits_a_phone_and_prints_without_an_empty_page(records, tmp_path):
    record = records["six_dof_points"]
    (tmp_path / "report.html").write_text(report_html(record, summarise(record)))
    with Browser(tmp_path, size=(390, 844)) as browser:
        browser.open((tmp_path / "report.html").as_uri())
        browser.wait("window.replay && replay.moments")
        assert browser.value("document.documentElement.scrollWidth <= innerWidth")
        pages = browser.printed(tmp_path / "report.pdf")
        assert all(len(page.split()) > 5 for page in pages)
        text = " ".join(" ".join(pages).split())
        assert "joints between their limits" in text and "the features in the image" in text and "Versions" in text
