"""A law of one's own: far from the goal every feature moves at one speed.   python3 examples/02_own_law.py"""
import numpy as np

import aras_visual_servo as avs


@avs.register_law("steady")
class Steady(avs.Law):
    """V_C = -L^+ Lambda clip(e): an error counts as 5 cm or 0.05 rad at most."""

    works_on, needs_plane = None, True  # any features; the interaction matrix L of the current view

    def _twist(self, look: avs.Look, s: np.ndarray, e: np.ndarray) -> np.ndarray:
        gains = np.array(avs.sampled_gains(self.gains_per_s, look.dt_s))
        return self.invert(self.features.matrix(look.view)) @ (-gains * np.clip(e, -0.05, 0.05))


for law in ("decoupled", "steady"):
    result = avs.judge(avs.run(avs.load_scenario("experiment_1", {"servo.law": law})))
    print(f"{law:<10} {result.duration_s:.2f} s  {result.final_error}")
