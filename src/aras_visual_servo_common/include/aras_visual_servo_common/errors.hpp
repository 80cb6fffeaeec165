#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace aras_visual_servo_common {

/** Base of everything these packages throw on purpose. The text names the thing, the value found, the value allowed. */
class ArasError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** One or more parameters are missing, unknown, of the wrong type or out of range; the text lists them all, one a line.
 */
class ParameterError : public ArasError {
 public:
  explicit ParameterError(const std::string& text);
  explicit ParameterError(const std::vector<std::string>& faults);

  /** The lines of the text. */
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  std::vector<std::string> faults_;
};

/** The robot description or another model cannot be used: malformed, incomplete or physically impossible. */
class ModelError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** An array has the wrong number of elements, or sizes and types disagree. */
class ShapeError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** A number that must be finite is NaN or infinite. */
class NotFiniteError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** Nothing of that name exists (a joint, link, controller, camera, model); the text lists what does. */
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

/** A feature was asked of a view that does not have it (no target, no orientation, cut by the border). */
class DegenerateFeature : public ArasError {
 public:
  using ArasError::ArasError;
};

}  // namespace aras_visual_servo_common
