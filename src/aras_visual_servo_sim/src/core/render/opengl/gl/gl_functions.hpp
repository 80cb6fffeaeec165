#pragma once

// For the types of the functions; none of them is linked.
#define GL_GLEXT_PROTOTYPES 1
#include <GL/gl.h>
#include <GL/glext.h>

#include <functional>

namespace aras_visual_servo_sim {

// The functions of OpenGL that the renderer calls, by their names without "gl".
// clang-format off
#define ARAS_GL_FUNCTIONS(visit) \
  visit(ActiveTexture) visit(AttachShader) visit(BindAttribLocation) visit(BindBuffer) visit(BindFramebuffer) \
  visit(BindRenderbuffer) visit(BindTexture) visit(BindVertexArray) visit(BlendFunc) visit(BlitFramebuffer) \
  visit(BufferData) visit(CheckFramebufferStatus) visit(Clear) visit(ClearColor) visit(ClearDepth) \
  visit(ClipControl) visit(ColorMask) visit(CompileShader) visit(CreateProgram) visit(CreateShader) \
  visit(CullFace) visit(DeleteBuffers) visit(DeleteFramebuffers) visit(DeleteProgram) \
  visit(DeleteRenderbuffers) visit(DeleteShader) visit(DeleteTextures) visit(DeleteVertexArrays) \
  visit(DepthFunc) visit(DepthMask) visit(Disable) visit(DrawArrays) visit(DrawBuffer) visit(DrawElements) \
  visit(Enable) visit(EnableVertexAttribArray) visit(FramebufferRenderbuffer) visit(FramebufferTexture2D) \
  visit(FrontFace) visit(GenBuffers) visit(GenFramebuffers) visit(GenRenderbuffers) visit(GenTextures) \
  visit(GenVertexArrays) visit(GenerateMipmap) visit(GetError) visit(GetIntegerv) visit(GetProgramInfoLog) \
  visit(GetProgramiv) visit(GetShaderInfoLog) visit(GetShaderiv) visit(GetString) visit(GetUniformLocation) \
  visit(LinkProgram) visit(PixelStorei) visit(ReadBuffer) visit(ReadPixels) \
  visit(RenderbufferStorageMultisample) visit(Scissor) visit(ShaderSource) visit(TexImage2D) visit(TexParameterf) \
  visit(TexParameteri) visit(Uniform1f) visit(Uniform1i) visit(Uniform2f) \
  visit(Uniform3f) visit(Uniform4f) visit(UniformMatrix3fv) visit(UniformMatrix4fv) visit(UseProgram) \
  visit(VertexAttribPointer) visit(Viewport)
// clang-format on

/** OpenGL as one context gives it.
 *
 *  Nothing is linked: OpenCV and ViSP bring libGL into the same process, and linked gl* symbols would resolve there,
 *  where there is no context of ours. */
struct GlFunctions {
#define ARAS_GL_MEMBER(name) decltype(&gl##name) name = nullptr;
  ARAS_GL_FUNCTIONS(ARAS_GL_MEMBER)
#undef ARAS_GL_MEMBER

  /** @param address  of a function by its full name, as OSMesaGetProcAddress
   *  @throws RenderError naming the function that is missing */
  static GlFunctions load(const std::function<void*(const char*)>& address);

  /** @throws RenderError naming the step and OpenGL's error, if there was one */
  void check(const char* step) const;
};

}  // namespace aras_visual_servo_sim
