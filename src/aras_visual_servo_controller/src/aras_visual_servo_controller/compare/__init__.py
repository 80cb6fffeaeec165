"""Comparisons: laws on the same tasks, runs side by side, sweeps against each other."""
