"""A run that takes its time, and what the tests of programs need of the machine."""
import os
import pathlib
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/aras_visual_servo_controller/test/support"))

from hang_up import hang_up_is_heard

__all__ = ["hang_up_is_heard", "own_master", "slow_scenario"]


@pytest.fixture
def slow_scenario(tmp_path):
    """Path of experiment_1 in real time: 15 s, so that there is something to look at, and to interrupt."""
    package = subprocess.run(["rospack", "find", "aras_visual_servo_controller"], stdout=subprocess.PIPE, text=True,
                             check=True).stdout.strip()
    text = (pathlib.Path(package) / "config" / "scenarios" / "experiment_1.yaml").read_text()
    assert "real_time_factor: 0.0" in text
    path = tmp_path / "slow.yaml"
    path.write_text(text.replace("real_time_factor: 0.0", "real_time_factor: 1.0"))
    return path


@pytest.fixture
def own_master():
    """The environment of who has no master and says nothing about where to listen."""
    kept = {key: value for key, value in os.environ.items() if key not in ("ROS_HOSTNAME", "ROS_IP")}
    return dict(kept, ROS_MASTER_URI="http://localhost:1")
