"""Errors that all packages raise, from Python and from C++.

`ArasError` is the base class. The bindings of the simulator, the camera and the kinematics raise these same classes.
"""
from typing import Any, Iterable, List, Union

__all__ = ["ArasError", "DegenerateFeature", "ModelError", "NotFiniteError", "ParameterError", "RenderError",
           "ShapeError", "StateError", "UnknownNameError"]


class ArasError(RuntimeError):
    """Base class of every error that these packages raise on purpose."""


class DegenerateFeature(ArasError):
    """A feature does not exist: no target, or no orientation because the object is isotropic."""


class ModelError(ArasError):
    """A robot description or another model cannot be used: malformed, incomplete or physically impossible."""


class NotFiniteError(ArasError):
    """A number is NaN or infinite where a finite one is needed."""


class ParameterError(ArasError):
    """A parameter is missing, unknown or out of range. One error lists every fault, one per line.

    Attributes:
        faults: one text for each fault, `[FILE:LINE: ]key: found X, allowed Y`.
    """

    def __init__(self, faults: Union[str, Iterable[Any]]) -> None:
        """Args: faults: one text, or texts or `Fault`s "key: found X, allowed Y"."""
        self.faults: List[str] = [faults] if isinstance(faults, str) else list(map(str, faults))
        super().__init__("\n".join(self.faults))


class RenderError(ArasError):
    """The renderer cannot be started, or cannot draw."""


class ShapeError(ArasError):
    """An array does not have the shape or the type that was asked for."""


class StateError(ArasError):
    """A saved state is damaged, or belongs to another model."""


class UnknownNameError(ArasError):
    """Nothing has this name; the text lists the names that exist."""
