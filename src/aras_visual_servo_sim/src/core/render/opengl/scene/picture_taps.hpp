#pragma once

#include <Eigen/Core>
#include <vector>

#include "gl_store.hpp"
#include "render/opengl/scene/shadow/shadow_reach.hpp"
#include "render/opengl/view/pinhole_view.hpp"

namespace aras_visual_servo_sim {

/** Rows of a picture in which a pixel's strip of a part's own picture takes at most so many taps. */
struct TapRows {
  PixelBox where;
  int taps;  ///< 1: it is no longer than wide
};

/** How many taps the picture of a part of a mesh takes, as few as keep it as sharp along a pixel's strip as across.
 *  llvmpipe runs through as many for each pixel of a draw call, and a loop costs it more than they do: what lies in a
 *  plane is therefore drawn in rows of few and rows of many.
 *  @param where  the pixels to be drawn  @param split  whether rows may differ */
std::vector<TapRows> tapRowsOf(const MeshPart& part, const Eigen::Matrix4d& X_CS, const PinholeView& view,
                               const PixelBox& where, bool split);

}  // namespace aras_visual_servo_sim
