"""A published protocol with a law of one's own beside one of ours.   python3 examples/08_own_law_in_a_benchmark.py"""
import numpy as np

import aras_visual_servo as avs


@avs.register_law("capped")
class Capped(avs.Law):
    """V_C = -L^+ Lambda e, scaled as a whole where the camera would be faster than 0.1 m/s or 0.5 rad/s."""

    works_on, needs_plane = None, True  # any features; the interaction matrix L of the current view

    def _twist(self, look: avs.Look, s: np.ndarray, e: np.ndarray) -> np.ndarray:
        gains = np.array(avs.sampled_gains(self.gains_per_s, look.dt_s))
        twist = self.invert(self.features.matrix(look.view)) @ (-gains * e)
        return twist / max(1.0, np.linalg.norm(twist[:3]) / 0.1, np.linalg.norm(twist[3:]) / 0.5)


for law in ("ibvs", "capped"):
    result = avs.benchmark("canonical", law=law, workers=0, quiet=True)  # 0: only this process knows the law
    headings, *lines = result.table
    for line in lines:
        row = dict(zip(headings, line))
        print(f"{row['law']:<8}{row['robot']:<14}{row['success']:>8}, 95 % interval {row['95 % interval']}")
