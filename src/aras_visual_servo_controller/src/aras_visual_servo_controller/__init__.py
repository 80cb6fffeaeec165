"""ROS side of ARAS Visual Servo: nodes, runs over ROS, bags, calibration and the real arm.

`__init__.pyi` lists the public names. Each is imported when it is first used: ROS only with what needs it.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
