#include "shader_program.hpp"

#include <iterator>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

ShaderProgram::ShaderProgram(const GlFunctions& gl, const std::string& name, const ShaderText& text) : gl_(gl) {
  const GLuint first = compile(GL_VERTEX_SHADER, name, text.vertex);
  GLuint second = 0;
  try {
    second = compile(GL_FRAGMENT_SHADER, name, text.fragment);
  } catch (const RenderError&) {
    gl_.DeleteShader(first);
    throw;
  }
  program_ = gl_.CreateProgram();
  for (const GLuint shader : {first, second}) {
    gl_.AttachShader(program_, shader);
    gl_.DeleteShader(shader);  // it goes with the program
  }
  for (GLuint k = 0; k < std::size(kAttributes); ++k) gl_.BindAttribLocation(program_, k, kAttributes[k]);
  gl_.LinkProgram(program_);
  GLint linked = 0, length = 0;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked) {
    ++made_;
    return;
  }
  gl_.GetProgramiv(program_, GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(static_cast<std::size_t>(length) + 1);
  gl_.GetProgramInfoLog(program_, length, nullptr, log.data());
  gl_.DeleteProgram(program_);
  throw RenderError("renderer 'opengl': shader '" + name + "' does not link: " + log.data());
}

ShaderProgram::~ShaderProgram() { gl_.DeleteProgram(program_); }

GLuint ShaderProgram::compile(GLenum type, const std::string& name, const std::string& source) const {
  const GLuint shader = gl_.CreateShader(type);
  const char* text = source.c_str();
  gl_.ShaderSource(shader, 1, &text, nullptr);
  gl_.CompileShader(shader);
  GLint compiled = 0, length = 0;
  gl_.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  gl_.GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(static_cast<std::size_t>(length) + 1);
  gl_.GetShaderInfoLog(shader, length, nullptr, log.data());
  gl_.DeleteShader(shader);
  throw RenderError("renderer 'opengl': shader '" + name + "' does not compile: " + log.data());
}

}  // namespace aras_visual_servo_sim
