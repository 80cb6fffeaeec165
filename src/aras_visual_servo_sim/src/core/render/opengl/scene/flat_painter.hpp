#pragma once

#include <memory>
#include <vector>

#include "gl_store.hpp"
#include "render/opengl/gl/shader_program.hpp"
#include "render/opengl/view/pinhole_view.hpp"
#include "render/planar/planar_layer.hpp"

namespace aras_visual_servo_sim {

/** Draws the flat targets of a scene, unlit, into the canvas that is bound. */
class FlatPainter {
 public:
  FlatPainter(const GlFunctions& gl, GlStore& store) : gl_(gl), store_(store) {}
  ~FlatPainter();

  /** @param layer  projected for the camera */
  void begin(const PlanarLayer& layer, const Pose& X_CW, double near_m);
  bool empty() const { return faces_.empty(); }
  /** Among and over the solids that are there. */
  void draw(const PinholeView& view);
  /** Gives the pixels full alpha where a solid that was drawn stands before a target. */
  void mark(const PinholeView& view);

 private:
  struct Face {
    PlanarLayer::Face face;
    GLint first = 0;
    GLsizei count = 0;
  };
  /** @param pictures  whether they are shown; marks need none */
  void drawFaces(const PinholeView& view, bool pictures);
  ShaderProgram& program(bool textured);

  const GlFunctions& gl_;
  GlStore& store_;
  std::unique_ptr<ShaderProgram> plain_, textured_;
  GLuint array_ = 0, buffer_ = 0;
  std::vector<float> vertices_;  // x y z s t
  std::vector<Face> faces_;
  double near_m_ = 0.0;
};

}  // namespace aras_visual_servo_sim
