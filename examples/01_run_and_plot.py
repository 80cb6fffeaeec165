"""Runs the paper's first experiment and plots how each feature error decays.   python3 examples/01_run_and_plot.py"""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import aras_visual_servo as avs

record = avs.run(avs.load_scenario("experiment_1"))
result = avs.judge(record)  # by the true pose of the camera, not by what the servo saw
print("passed" if result.passed else "failed", result.final_error)

rows = record.servo_rows
for name, error in zip(record.feature_names, record.e[rows].T):
    plt.semilogy(record.t_s[rows] - record.t_s[rows[0]], np.abs(error), label=name)
plt.xlabel("time [s]")
plt.ylabel("|s - s*| [m, rad]")
plt.legend()
plt.savefig("errors.png")
