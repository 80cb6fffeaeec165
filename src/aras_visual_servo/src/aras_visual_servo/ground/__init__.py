"""The ground every room stands on: errors, the data that flows between camera, servo and robot, and rotations."""
