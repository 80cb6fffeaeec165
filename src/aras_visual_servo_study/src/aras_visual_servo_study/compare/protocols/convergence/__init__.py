"""Protocol `map`: from where each law arrives with each set of features; `sets` says which they are."""

from .protocol import ConvergenceMap

__all__ = ["ConvergenceMap"]
