#pragma once

#include <pybind11/pybind11.h>

/** Adds `solve_program`, which solves a quadratic program. */
void bindProgram(pybind11::module_& module);
