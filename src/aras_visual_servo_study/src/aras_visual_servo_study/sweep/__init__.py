"""Sweeps: many runs of a scenario are planned, run on every core, stored, judged and shown."""
