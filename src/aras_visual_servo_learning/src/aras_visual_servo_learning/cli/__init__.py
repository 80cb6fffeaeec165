"""The verbs of `aras-servo` that this package has."""
