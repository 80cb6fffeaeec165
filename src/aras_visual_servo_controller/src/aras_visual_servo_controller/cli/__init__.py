"""Verbs of `aras-servo` that need this package."""
