#include "canvas.hpp"

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

Canvas::Canvas(const GlFunctions& gl, int width, int height, bool multisampled, bool fine, bool deep)
    : gl_(gl), width_(width), height_(height) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  if (width > most || height > most) {
    throw RenderError("renderer 'opengl': found a picture of " + std::to_string(width) + " x " +
                      std::to_string(height) + " px, allowed up to " + std::to_string(most) + " px a side");
  }
  const auto storage = [&](GLuint& buffer, GLenum stored, int samples, GLenum attachment) {
    gl_.GenRenderbuffers(1, &buffer);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, stored, width_, height_);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  };
  const GLenum format = fine ? GL_RGBA16 : GL_RGBA8;
  gl_.GenFramebuffers(1, &drawn_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  storage(color_, format, multisampled ? kSamples : 0, GL_COLOR_ATTACHMENT0);
  if (deep) storage(depth_, GL_DEPTH_COMPONENT32F, multisampled ? kSamples : 0, GL_DEPTH_ATTACHMENT);
  GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (multisampled && status == GL_FRAMEBUFFER_COMPLETE) {
    gl_.GenFramebuffers(1, &resolved_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, resolved_);
    storage(resolved_color_, format, 0, GL_COLOR_ATTACHMENT0);
    status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  }
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("renderer 'opengl': no picture of " + std::to_string(width) + " x " + std::to_string(height) +
                      " px (framebuffer status " + std::to_string(status) + ")");
  }
}

Canvas::~Canvas() {
  for (GLuint* frame : {&drawn_, &resolved_}) {
    if (*frame) gl_.DeleteFramebuffers(1, frame);
  }
  for (GLuint* buffer : {&color_, &depth_, &resolved_color_}) {
    if (*buffer) gl_.DeleteRenderbuffers(1, buffer);
  }
}

void Canvas::bind() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl_.Viewport(0, 0, width_, height_);
}

template <typename Pixel>
void Canvas::read(const PixelBox& box, std::vector<Pixel>& pixels) const {
  pixels.resize(std::size_t(width_) * height_);
  if (box.empty()) return;
  if (resolved_) {
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
    gl_.BlitFramebuffer(box.u0, box.v0, box.u1, box.v1, box.u0, box.v0, box.u1, box.v1, GL_COLOR_BUFFER_BIT,
                        GL_NEAREST);
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  }
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl_.PixelStorei(GL_PACK_ROW_LENGTH, width_);
  Pixel* first = pixels.data() + std::size_t(box.v0) * width_ + box.u0;
  gl_.ReadPixels(box.u0, box.v0, box.u1 - box.u0, box.v1 - box.v0, GL_RGBA,
                 sizeof(Pixel) == 4 ? GL_UNSIGNED_BYTE : GL_UNSIGNED_SHORT, first);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_);
}

template void Canvas::read(const PixelBox&, std::vector<std::uint32_t>&) const;
template void Canvas::read(const PixelBox&, std::vector<std::uint64_t>&) const;

}  // namespace aras_visual_servo_sim
