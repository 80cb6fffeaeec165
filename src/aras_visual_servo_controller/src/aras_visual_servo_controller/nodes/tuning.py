"""Gains and thresholds of a controller that runs: dynamic_reconfigure's server `~tuning`, which rqt and dynparam know.

    rosrun dynamic_reconfigure dynparam set /aras_visual_servo/controller/tuning gain_xn 1.5

The numbers act from the next image on, also while a goal is active, and stay for later goals.
"""

from types import SimpleNamespace

import rospy
from dynamic_reconfigure.server import Server

from ..ground.errors import ParameterError

LEAST, MOST = 1e-9, 1e6
KINDS = {"gain": ("gains_per_s", "[1/s] rate at which the error decays"),
         "threshold": ("thresholds", "converged when the error is below this")}


class Tuning:
    """The server. Args: servo: `Servo`. lock: that is held while the servo answers an image."""

    def __init__(self, servo, lock):
        self._servo, self._lock, self._begun = servo, lock, False
        self._server = Server(description(servo), self._on_change, "~tuning")
        self._begun = True

    def _on_change(self, config, _level):
        with self._lock:
            if not self._begun:  # the server begins with what an earlier node left: the scenario counts
                config.update(values_of(self._servo))
                return config
            given = {key: {name: config[f"{kind}_{name}"] for name in self._servo.feature_names}
                     for kind, (key, _) in KINDS.items()}
            try:
                self._servo.retune(**given)
                now = self._servo.config
                rospy.loginfo("gains %s /s, thresholds %s", now.gains_per_s, now.thresholds)
            except ParameterError as error:
                rospy.logerr("tuning refused: %s", error)
            config.update(values_of(self._servo))
            return config


def values_of(servo):
    """Name of a parameter -> value in use."""
    return {f"{kind}_{name}": value for kind, (key, _) in KINDS.items()
            for name, value in zip(servo.feature_names, getattr(servo.config, key))}


def description(servo):
    """What dynamic_reconfigure generates from a .cfg file, made for the features of this servo."""
    values = values_of(servo)
    parameters = [{"name": name, "type": "double", "default": value, "min": LEAST, "max": MOST, "level": 1,
                   "description": KINDS[name.partition("_")[0]][1], "edit_method": ""}
                  for name, value in values.items()]
    group = {"name": "Default", "type": "", "state": True, "cstate": "true", "id": 0, "parent": 0, "parentname": "",
             "parentclass": "", "class": "DEFAULT", "field": "default", "upper": "DEFAULT", "lower": "groups",
             "parameters": parameters, "groups": []}
    return SimpleNamespace(config_description=group, defaults=dict(values), level=dict.fromkeys(values, 1),
                           min=dict.fromkeys(values, LEAST), max=dict.fromkeys(values, MOST),
                           type=dict.fromkeys(values, "double"), all_level=1)
