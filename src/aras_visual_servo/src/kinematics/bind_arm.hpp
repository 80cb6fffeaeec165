#pragma once

#include <pybind11/pybind11.h>

/** Adds what turns a camera twist into joint velocities: Inverse, Transpose, Wish, and the factors of the limits. */
void bindArm(pybind11::module_& module);
