"""The planar target: its outline in the image, and its pose from moments or points."""
