"""Errors of the controller core: one base class, and classes named after the cause of the error.

Events of a normal run (target lost, joint limit, ...) are a `types.Status`, not an exception.
"""


class ArasError(RuntimeError):
    """Base of every error the package raises on purpose."""


class ModelError(ArasError):
    """A robot model cannot be used: bad URDF, unknown link, no moving joint between two links."""


class ParameterError(ArasError):
    """A parameter is missing, unknown or out of range. One error lists every fault, one per line."""

    def __init__(self, faults):
        """Args: faults: one text or a sequence of texts `key: found X, allowed Y`."""
        self.faults = [faults] if isinstance(faults, str) else list(faults)
        super().__init__("\n".join(self.faults))


class ShapeError(ArasError):
    """An array does not have the shape that was asked for."""


class NotFiniteError(ArasError):
    """A number is NaN or infinite where a finite one is needed."""


class DegenerateFeature(ArasError):
    """A feature does not exist: empty object, or no orientation because the object is isotropic."""
