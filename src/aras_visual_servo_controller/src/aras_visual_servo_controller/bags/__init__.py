"""Bags: recorded topics, reading a run from a recording, and replay of its images."""
