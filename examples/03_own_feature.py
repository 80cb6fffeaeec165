"""A feature of one's own: the logarithm of the depth.   python3 examples/03_own_feature.py"""
from math import log

import numpy as np

import aras_visual_servo as avs


@avs.register_feature("log_an")
class LogDepth(avs.Feature):
    """ln(an): the same step of it is the same share of the distance, near and far [-]."""

    order = 2  # of the moments that value and row need
    unit, symbol, label = "-", "λ_a", "logarithm of the depth"  # how plots and tables show it

    def value(self, view: avs.View) -> float:
        return log(view.features.an)

    def row(self, view: avs.View) -> np.ndarray:
        return view.L_normalised()[2] / view.features.an  # d ln(an) = d an / an


scenario = avs.load_scenario("experiment_1", {
    "servo.law": "ibvs", "servo.features": ["xn", "yn", "log_an", "alpha"],
    "servo.gains_per_s": {"xn": 3.0, "yn": 3.0, "log_an": 3.0, "alpha": 3.0},
    "servo.thresholds": {"xn": 5e-5, "yn": 1.5e-4, "log_an": 1e-4, "alpha": 3e-4}})
result = avs.judge(avs.run(scenario))
print("passed" if result.passed else "failed", result.final_error)
