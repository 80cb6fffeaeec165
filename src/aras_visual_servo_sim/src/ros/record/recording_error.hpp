#pragma once

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** A bag cannot be written; the text says which and why. */
class RecordingError : public ArasError {
 public:
  using ArasError::ArasError;
};

}  // namespace aras_visual_servo_sim
