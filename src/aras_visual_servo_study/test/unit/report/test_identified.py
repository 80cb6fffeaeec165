"""The page of an identified arm."""
import re

import numpy as np
import pytest

from aras_visual_servo_study.report.identified import _spectrum, identified_html


def test_the_page_shows_every_joint_parameter_and_gap():
    rng, times = np.random.default_rng(0), np.arange(0.0, 10.0, 0.01)
    measured = np.sin(times)[:, None] * np.ones(2) + rng.normal(0.0, 1e-4, (1000, 2))
    rows = [{"name": "J1.friction", "value": "0.3", "interval": "0.2 to 0.4", "unit": "N m"}]
    unknown = [{"name": "J2.friction", "others": "J2.d", "motion": "move J2 alone"}]
    page = identified_html("an arm & more", "aras-servo identify", ("J1", "J2"), times, measured,
                           np.sin(times)[:, None] * np.ones(2), 750, rows, unknown, ["a note"],
                           {"J1": (1e3, "mm"), "J2": (180.0 / np.pi, "deg")})
    assert re.findall(r'<figure id="(\w+)"', page) == ["joint_0", "joint_1", "residual", "spectrum"]
    for text in ("an arm &amp; more", "<td>0.2 to 0.4</td>", "<td>move J2 alone</td>", "from 7.5 s on", "a note",
                 "frequency [Hz]", "time since the first command [s]"):
        assert text in page, text
    rms = {name: float(value) for name, value in re.findall(r"<tr><td>(J\d \[\w+\])</td><td>([\d.e-]+)</td>", page)}
    assert rms == {"J1 [mm]": pytest.approx(0.1, rel=0.1), "J2 [deg]": pytest.approx(0.00573, rel=0.1)}
    hertz, density = _spectrum(times, measured - np.sin(times)[:, None])
    np.testing.assert_allclose(hertz[-1], 50.0)
    np.testing.assert_allclose(np.sqrt(np.mean(density**2) * 50.0), 1e-4, rtol=0.1)  # Parseval
