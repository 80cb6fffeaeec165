"""ROS side of ARAS Visual Servo: nodes, runs over ROS, bags, calibration and the real arm.

`__init__.pyi` lists the public names. Each is imported on first use: ROS only for names that need it.
"""

from typing import Any

import lazy_loader

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    value = _load(name)
    globals()[name] = value  # found here from now on
    return value
