#include "osmesa_canvas.hpp"

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

OsmesaCanvas::OsmesaCanvas(int width, int height)
    : gl_(OsmesaLibrary::instance()), width_(width), height_(height), pixels_(std::size_t(width) * height) {
  constexpr int kDepthBits = 24;
  context_ = gl_.createContext(OSMESA_RGBA, kDepthBits, 0, 0, nullptr);
  if (!context_) throw RenderError("OSMesa: no context with a depth buffer of 24 bits");
  if (!gl_.makeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width, height)) {
    gl_.destroyContext(context_);
    throw RenderError("OSMesa: no picture of " + std::to_string(width) + " x " + std::to_string(height) + " px");
  }
  gl_.viewport(0, 0, width, height);
  gl_.disable(GL_DITHER);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_GREATER);
  gl_.clearDepth(0.0);
  gl_.enableClientState(GL_VERTEX_ARRAY);
  gl_.enableClientState(GL_COLOR_ARRAY);
  gl_.matrixMode(GL_PROJECTION);
  gl_.loadIdentity();
  // OSMesa stores the row of least y first, so y may grow downwards all through. glOrtho's depth runs along -z.
  gl_.ortho(0.0, width, 0.0, height, 0.0, -1.0);
}

OsmesaCanvas::~OsmesaCanvas() { gl_.destroyContext(context_); }

const std::uint32_t* OsmesaCanvas::draw(const std::vector<GlVertex>& vertices, const Rgb& background) {
  if (!gl_.makeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_, height_)) {
    throw RenderError("OSMesa: the context was lost");
  }
  gl_.clearColor(background.r / 255.0f, background.g / 255.0f, background.b / 255.0f, 0.0f);
  gl_.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (!vertices.empty()) {
    gl_.vertexPointer(3, GL_FLOAT, sizeof(GlVertex), &vertices[0].x);
    gl_.colorPointer(4, GL_UNSIGNED_BYTE, sizeof(GlVertex), vertices[0].rgba.data());
    gl_.drawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  }
  gl_.finish();  // copies the picture to pixels_
  const GLenum error = gl_.getError();
  if (error != GL_NO_ERROR) throw RenderError("OSMesa: OpenGL error " + std::to_string(error));
  return pixels_.data();
}

}  // namespace aras_visual_servo_sim
