#pragma once

namespace aras_visual_servo_sim {

constexpr double kImmovable = 1e-300;
// The friction at four corners of a face has more unknowns than a body has sideways motions, so the equations do not
// say how much each corner carries. This part of the stiffness is added to them; it keeps Newton's step near the
// previous solution, and leaves about this part of the slip.
constexpr double kStay = 1e-7;

}  // namespace aras_visual_servo_sim
