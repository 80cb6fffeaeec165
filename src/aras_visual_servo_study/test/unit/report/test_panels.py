"""What stands on the six panels: the numbers of the record, in the colours of the features."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from synthetic import X_WCG, make_record

from aras_visual_servo import styles
from aras_visual_servo_study.report.figure import draw_panel
from aras_visual_servo_study.report.pictures import image_of

NOTHING = make_record(servo_images=1)


def panel(record, name, **options):
    axes = Figure().add_subplot(projection=Axes3D.name if name == "path" else None)
    draw_panel(record, name, axes, **options)
    return axes


@pytest.fixture(scope="module")
def record():
    return make_record()


def seconds(record):
    stamps = record.stamp_ns[record.servo_rows]
    return 1e-9 * (stamps - stamps[0])


def test_errors_are_drawn_over_time_in_the_colours_of_their_features(record):
    axes = panel(record, "errors")
    zero, *curves = axes.lines
    assert len(curves) == 4 and not np.any(zero.get_ydata())
    for curve, style, column in zip(curves, styles(record.feature_names), record.e[record.servo_rows].T):
        np.testing.assert_array_equal(curve.get_ydata(), column)
        np.testing.assert_allclose(curve.get_xdata(), seconds(record))
        assert curve.get_color() == style.colour and curve.get_label() == style.mathtext
    assert axes.get_xlim() == (0.0, pytest.approx(seconds(record)[-1])) and axes.get_legend()


def test_all_six_velocities_are_drawn_and_told_apart(record):
    zero, *curves = panel(record, "velocity").lines
    assert len(curves) == 6 and len({(curve.get_color(), curve.get_linestyle()) for curve in curves}) == 6
    for curve, column in zip(curves, record.twist[record.servo_rows].T):
        np.testing.assert_array_equal(curve.get_ydata(), column)


def test_the_path_leads_from_a_circle_to_the_star_within_a_cube(record):
    axes = panel(record, "path")
    way, start, goal = (np.array(line.get_data_3d()) for line in axes.lines)
    p = record.X_WC[record.servo_rows, :3, 3]
    np.testing.assert_array_equal(way, p.T)
    np.testing.assert_array_equal(start[:, 0], p[0])
    np.testing.assert_array_equal(goal[:, 0], X_WCG[:3, 3])
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    points = np.vstack([p, X_WCG[:3, 3]])
    np.testing.assert_allclose(limits.mean(axis=1), 0.5 * (points.max(axis=0) + points.min(axis=0)), atol=1e-12)
    widest = (points.max(axis=0) - points.min(axis=0)).max()
    np.testing.assert_allclose(limits[:, 1] - limits[:, 0], 1.08 * widest, rtol=1e-9)


@pytest.mark.parametrize("name", ["desired", "initial", "difference", "start"])
def test_an_image_is_shown_in_its_own_greys_with_lines_through_its_middle(record, name):
    axes = panel(record, name)
    [image] = axes.images
    np.testing.assert_array_equal(image.get_array(), image_of(record, name))
    assert image.get_clim() == (0, 255) and not axes.texts
    assert {line.get_ydata()[0] for line in axes.lines[::2]} == {23.5} and axes.lines[1].get_xdata()[0] == 31.5


def test_a_panel_has_its_letter_and_title_when_asked_for(record):
    assert panel(record, "errors", letter="d").get_title().startswith("(d) ")
    assert not panel(record, "errors", letter="d").get_title() == panel(record, "errors").get_title()
    assert panel(record, "errors", title=False).get_title() == ""
    with pytest.raises(ValueError, match="panel 'nothing': allowed are"):
        draw_panel(record, "nothing", None, title=False)
