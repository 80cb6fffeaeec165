"""Calibration of what a real arm needs: the camera, where it is on the arm, and where the target is."""
