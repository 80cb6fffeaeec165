"""Additions for a real arm: joints at the time of an image, latency, limits, stops."""
