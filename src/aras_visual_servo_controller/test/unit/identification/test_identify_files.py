"""Files that `aras-servo identify` writes: no robot from a fit that did not converge."""
import json
from types import SimpleNamespace

import numpy as np
import pytest

from aras_visual_servo.cli.main import main
from aras_visual_servo_controller.cli import identify
from aras_visual_servo_controller.identification import twin
from aras_visual_servo_controller.identification.estimates import Identified


@pytest.mark.parametrize("converged", [True, False])
def test_a_robot_is_written_of_a_fit_that_converged_only(converged, tmp_path, monkeypatch):
    found = SimpleNamespace(identified=Identified({}, [], 0.0), bandwidth={}, converged=converged, by_noise=1.0,
                            names=[], held_out={"position": 1e-4}, covariance=np.zeros((0, 0)), joint_names=["a"],
                            times_s=None, measured=None, simulated=None, fitted=None,
                            overlay={"robot": {"dynamics": {}}})
    monkeypatch.setattr(identify, "_recording", lambda *_: (None, ()))
    monkeypatch.setattr(twin, "identify_twin", lambda *_, **__: found)
    monkeypatch.setattr(identify, "study", lambda _: SimpleNamespace(
        identified_html=lambda *_: "<html>", shown_units=lambda _: {"position": (1e3, "mm")}))
    (tmp_path / "a.bag").touch()
    code = main(["identify", str(tmp_path / "a.bag"), "--robot", "so101", "--out", str(tmp_path / "out")])
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert json.loads((tmp_path / "out" / "identified.json").read_text())["converged"] is converged
    assert names - {"identified.html", "identified.json"} == ({"robot.identified.yaml"} if converged else set())
    assert code == (0 if converged else 1)
