#pragma once

#include <stdexcept>

namespace aras_visual_servo_sim {

/** Base of everything this package throws on purpose. The text names the thing, the value found, the value allowed. */
class ArasError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** The robot description cannot be used: malformed, incomplete or physically impossible. */
class ModelError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** One or more parameters are missing, unknown, of the wrong type or out of range; the text lists them all. */
class ParameterError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** A number that must be finite is NaN or infinite. */
class NotFiniteError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** An array has the wrong number of elements. */
class ShapeError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** A joint, link, controller, camera or model of that name does not exist; the text lists those that do. */
class UnknownNameError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** A saved state does not belong to this model or is damaged. */
class StateError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** The renderer could not be started or could not draw. */
class RenderError : public ArasError {
 public:
  using ArasError::ArasError;
};

}  // namespace aras_visual_servo_sim
