"""Bags: what is recorded, reading a run back from a recording, and replaying its images."""
