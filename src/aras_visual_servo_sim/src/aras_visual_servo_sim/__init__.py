"""Simulator of a jointed robot with cameras, in process: no ROS needed.

>>> sim = Simulation("arm.urdf", config, controllers, package_paths={"aras_description": "/path"})
>>> stamp_ns = sim.step_to_image("camera")
>>> image = sim.render("camera")

A :class:`World` holds many robots, which see and touch each other; a :class:`Simulation` is a world that is its one
:class:`Robot`.

Everything is in SI units; twists are stacked [v; w]; joints are named, vectors are in the order of
``sim.joint_names`` (sorted by name). Errors derive from :class:`ArasError`, a ``RuntimeError``.
"""
from ._sim import (
    ArasError,
    Frame,
    ModelError,
    NotFiniteError,
    ParameterError,
    RenderError,
    Robot,
    ShapeError,
    Simulation,
    StateError,
    UnknownNameError,
    World,
    light_entry,
    mesh_triangles,
    opengl_description,
)

__all__ = [
    "ArasError",
    "Frame",
    "ModelError",
    "NotFiniteError",
    "ParameterError",
    "RenderError",
    "Robot",
    "ShapeError",
    "Simulation",
    "StateError",
    "UnknownNameError",
    "World",
    "light_entry",
    "mesh_triangles",
    "opengl_description",
]
