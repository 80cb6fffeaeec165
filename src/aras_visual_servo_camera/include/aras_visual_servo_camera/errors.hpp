#pragma once

#include <stdexcept>

namespace aras_visual_servo_camera {

/** Base of everything this package throws. The text names the thing, the value found and the value allowed. */
struct ArasError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** A configuration or camera_info that cannot be used; lists every fault, one per line. */
struct ParameterError : ArasError {
  using ArasError::ArasError;
};

/** Sizes or types that disagree. */
struct ShapeError : ArasError {
  using ArasError::ArasError;
};

/** A number that is NaN or infinite where a finite one is needed. */
struct NotFiniteError : ArasError {
  using ArasError::ArasError;
};

/** A feature was asked of a view that does not have it (no target, no orientation, cut by the border). */
struct DegenerateFeature : ArasError {
  using ArasError::ArasError;
};

}  // namespace aras_visual_servo_camera
