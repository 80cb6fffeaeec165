"""The packages in this folder, written as for Gazebo, are found as those of a workspace are."""
import os
import pathlib

import pytest


@pytest.fixture(autouse=True, scope="module")
def package_path():
    """Puts this folder first in ROS_PACKAGE_PATH."""
    before = os.environ.get("ROS_PACKAGE_PATH", "")
    os.environ["ROS_PACKAGE_PATH"] = "%s:%s" % (pathlib.Path(__file__).resolve().parent, before)
    yield
    os.environ["ROS_PACKAGE_PATH"] = before
