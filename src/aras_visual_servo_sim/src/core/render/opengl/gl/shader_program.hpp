#pragma once

#include <atomic>
#include <string>

#include "gl_functions.hpp"

namespace aras_visual_servo_sim {

/** Two shaders in OpenGL's language. */
struct ShaderText {
  std::string vertex, fragment;
};

/** A vertex and a fragment shader, linked. Vertices have the attributes of kAttributes, by their places in it. Its
 *  context is bound whenever one of its functions is called, and still there when it goes. */
class ShaderProgram {
 public:
  static constexpr const char* kAttributes[] = {"position", "normal", "coordinates", "color"};

  /** @param name  for messages @throws RenderError with the compiler's words */
  ShaderProgram(const GlFunctions& gl, const std::string& name, const ShaderText& text);
  ~ShaderProgram();
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  /** How many were made so far, in the whole process. */
  static long made() { return made_; }

  void use() const { gl_.UseProgram(program_); }
  /** Location of a uniform; -1, which OpenGL ignores, if the shader does not use it. */
  GLint operator[](const char* uniform) const { return gl_.GetUniformLocation(program_, uniform); }

 private:
  GLuint compile(GLenum type, const std::string& name, const std::string& source) const;

  static inline std::atomic<long> made_ = 0;

  const GlFunctions& gl_;
  GLuint program_ = 0;
};

}  // namespace aras_visual_servo_sim
