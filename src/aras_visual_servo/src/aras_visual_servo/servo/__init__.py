"""The servo: one observation in, one command out, with everything that decides in between."""
