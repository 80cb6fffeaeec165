"""Scenarios: loading, checking, and whether a run can be done at all."""
