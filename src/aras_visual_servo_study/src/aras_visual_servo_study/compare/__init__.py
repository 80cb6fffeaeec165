"""Compares laws on the same tasks, runs side by side, and sweeps with each other."""
