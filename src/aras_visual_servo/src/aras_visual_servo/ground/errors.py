"""Errors of the controller core, which are those of all packages.

Events of a normal run (target lost, joint limit, ...) are a `types.Status`, not an exception.
"""
from aras_visual_servo_common import (ArasError, DegenerateFeature, ModelError, NotFiniteError, ParameterError,
                                      ShapeError)

__all__ = ["ArasError", "DegenerateFeature", "ModelError", "NotFiniteError", "ParameterError", "ShapeError"]
