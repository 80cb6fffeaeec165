#pragma once

#include <string>

#include "render/opengl/gl/shader_program.hpp"

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

/** Of solids: lit for each pixel, in the frame of the camera, or once for a triangle that is lit evenly. */
ShaderText solidShader(const ShaderTraits& traits);
/** Of what has one colour or a picture, unlit: flat targets. */
ShaderText flatShader(bool textured);
/** Of shadow maps: depth alone. */
ShaderText depthShader();
/** Of the sky behind everything: one triangle over the whole picture. */
ShaderText skyShader();

}  // namespace aras_visual_servo_sim
