"""A run that takes its time, and what the tests of programs need of the machine."""
import os
import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/aras_visual_servo/test/support"))

from hang_up import hang_up_is_heard

__all__ = ["hang_up_is_heard", "own_master", "slow_scenario"]


@pytest.fixture
def slow_scenario(tmp_path):
    """Path of a scenario: experiment_1 in real time, for minutes, so that it can be looked at and ended."""
    path = tmp_path / "slow.yaml"
    path.write_text("name: slow\nextends: experiment_1\ntime: {real_time_factor: 1.0}\n"
                    "servo: {hold_s: 900.0, time_limit_s: 1000.0}\n")
    return path


@pytest.fixture
def own_master():
    """The environment of who has no master and says nothing about where to listen."""
    kept = {key: value for key, value in os.environ.items() if key not in ("ROS_HOSTNAME", "ROS_IP")}
    return dict(kept, ROS_MASTER_URI="http://localhost:1")
