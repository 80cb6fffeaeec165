#pragma once

#include <string>
#include <vector>

#include "gl_lights.hpp"

namespace aras_visual_servo_sim {

/** What of a shader is wanted: one is compiled for each set of these, so that simple scenes are drawn by short ones. */
struct ShaderTraits {
  std::string lights;  ///< a letter each: 'd'irectional, 'p'oint, 's'pot, 'h'ead; capital: with a shadow
  bool clamps_light = false, textured = false, bumpy = false, specular = false, fog = false;

  std::string name() const;
};

/** Letters of ShaderTraits::lights. */
std::string lightLetters(const LightSet& lights);

/** Of solids: lit for each pixel, in the frame of the camera. */
std::string solidVertexShader();
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
