#pragma once

#include <string>
#include <vector>

#include "gl_lights.hpp"

namespace aras_visual_servo_sim {

/** What of a shader is wanted: one is compiled for each set of these, so that simple scenes are drawn by short ones. */
struct ShaderTraits {
  std::string lights;  ///< a letter each: 'd'irectional, 'p'oint, 's'pot, 'h'ead; capital: with a shadow
  bool clamps_light = false, textured = false, bumpy = false, specular = false, fog = false;
  int taps = 1;                              ///< of textured ones: how many of the picture each pixel takes
  static constexpr double kTapLength = 2.0;  ///< how long the piece of a strip is for one tap, over the strip's width
  bool sharp = false;                        ///< of specular ones: the highlight has an exponent other than 1
  bool by_root = false;                      ///< of specular ones: the exponent is 3/2, as most of Gazebo's are
  bool faceted = false;                      ///< each triangle has one normal and one colour, and its back is not drawn
  bool two_sided = false;                    ///< the back is drawn, lit as a front
  bool painted = false;                      ///< the mesh has colours of its own

  std::string name() const;
};

/** Letters of ShaderTraits::lights. */
std::string lightLetters(const LightSet& lights);

/** Of solids: lit for each pixel, in the frame of the camera; what is the same all over a triangle, for it as a whole.
 */
std::string solidVertexShader(const ShaderTraits& traits);
std::string solidFragmentShader(const ShaderTraits& traits);
/** Of what has one colour or a picture, unlit: flat targets. */
std::string flatVertexShader();
std::string flatFragmentShader(bool textured);
/** Of shadow maps: depth alone. */
std::string depthVertexShader();
std::string depthFragmentShader();
/** Of the sky behind everything: one triangle over the whole picture. */
std::string skyVertexShader();
std::string skyFragmentShader();

}  // namespace aras_visual_servo_sim
