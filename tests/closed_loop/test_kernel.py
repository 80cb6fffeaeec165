"""Kernel projections in the closed loop, judged by the true camera pose."""

import aras_visual_servo as avs

# The promise for coverage images, see test_in_process.py.
COVERAGE_MM_DEG = {"x_mm": 0.2, "y_mm": 0.2, "z_mm": 0.5, "angle_deg": 0.05}


def test_arrives_on_kernel_projections(run):
    judgement = avs.judge(run("kernel"))
    assert judgement.converged, judgement.reason
    for name, bound in COVERAGE_MM_DEG.items():
        assert abs(judgement.final_error[name]) <= bound, (name, judgement.final_error)
    assert max(abs(judgement.initial_error[axis]) for axis in ("x_mm", "y_mm", "z_mm")) > 50.0
