#pragma once

#include <memory>
#include <vector>

#include "gl_store.hpp"
#include "render/opengl/view/pinhole_view.hpp"
#include "render/planar/planar_layer.hpp"
#include "solid_shader.hpp"

namespace aras_visual_servo_sim {

/** Draws the flat targets of a scene, unlit, into the canvas that is bound. */
class FlatPainter {
 public:
  FlatPainter(const GlFunctions& gl, GlStore& store) : gl_(gl), store_(store) {}
  ~FlatPainter() {
    if (array_) gl_.DeleteVertexArrays(1, &array_);
    if (buffer_) gl_.DeleteBuffers(1, &buffer_);
  }

  /** @param layer  projected for the camera */
  void begin(const PlanarLayer& layer, const Pose& X_CW, double near_m) {
    near_m_ = near_m;
    vertices_.clear();
    faces_.clear();
    constexpr std::size_t kFloats = 5;
    for (const PlanarLayer::Face& face : layer.faces()) {
      const PlanarModel& model = *face.model;
      const Pose X_CM = X_CW * model.X_WM;
      const auto first = static_cast<GLint>(vertices_.size() / kFloats);
      const auto add = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& size) {
        const Eigen::Vector3f p_C = (X_CM * Eigen::Vector3d(p.x(), p.y(), 0.0)).cast<float>();
        vertices_.insert(vertices_.end(), {p_C.x(), p_C.y(), p_C.z(), static_cast<float>(0.5 + p.x() / size.x()),
                                           static_cast<float>(0.5 - p.y() / size.y())});
      };
      if (face.kind == PlanarLayer::Face::Kind::kOutlines) {
        for (std::size_t k = 0; k < model.outlines().size(); ++k) {
          for (const auto& triangle : model.triangles(k)) {
            for (const std::uint32_t corner : triangle) add(model.outlines()[k][corner], {1.0, 1.0});
          }
        }
      } else {
        const bool picture = face.kind == PlanarLayer::Face::Kind::kPicture;
        const Polygon& corners = picture ? model.pictureCorners() : model.boardCorners();
        for (const int corner : {0, 1, 2, 0, 2, 3}) {
          add(corners[corner], picture ? model.picture()->size_m : model.board()->size_m);
        }
      }
      faces_.push_back({face, first, static_cast<GLsizei>(vertices_.size() / kFloats) - first});
    }
    if (faces_.empty()) return;
    if (!array_) {
      gl_.GenVertexArrays(1, &array_);
      gl_.GenBuffers(1, &buffer_);
      gl_.BindVertexArray(array_);
      gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
      gl_.EnableVertexAttribArray(0);
      gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kFloats * sizeof(float), nullptr);
      gl_.EnableVertexAttribArray(2);
      gl_.VertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, kFloats * sizeof(float),
                              reinterpret_cast<const void*>(3 * sizeof(float)));
    }
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(float)), vertices_.data(),
                   GL_STREAM_DRAW);
  }

  bool empty() const { return faces_.empty(); }
  /** Among and over the solids that are there. */
  void draw(const PinholeView& view) {
    gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    gl_.DepthMask(GL_TRUE);
    gl_.DepthFunc(GL_GEQUAL);
    drawFaces(view, /*pictures=*/true);
  }

  /** Gives the pixels full alpha where a solid that was drawn stands before a target. */
  void mark(const PinholeView& view) {
    gl_.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
    gl_.DepthMask(GL_FALSE);
    gl_.DepthFunc(GL_LESS);
    drawFaces(view, /*pictures=*/false);
    gl_.DepthMask(GL_TRUE);
  }

 private:
  struct Face {
    PlanarLayer::Face face;
    GLint first = 0;
    GLsizei count = 0;
  };
  /** @param pictures  whether they are shown; marks need none */
  void drawFaces(const PinholeView& view, bool pictures) {
    gl_.Disable(GL_CULL_FACE);
    const Eigen::Matrix4f projection = view.projection(near_m_);
    int index = 0;
    for (const Face& each : faces_) {
      const bool picture = pictures && each.face.kind == PlanarLayer::Face::Kind::kPicture;
      const ShaderProgram& shader = program(picture);
      shader.use();
      gl_.UniformMatrix4fv(shader["projection"], 1, GL_FALSE, projection.data());
      constexpr float kBias = 1e-6f;  // in units of near_m / Z, TriangleList's
      gl_.Uniform1f(shader["bias"], kBias * static_cast<float>(++index));
      if (picture) {
        gl_.Uniform1i(shader["picture"], 0);
        store_.bindPicture(each.face.model->picture()->texture, Wrap::kClamp, Wrap::kClamp, /*askew=*/true);
      } else {
        const Rgb& color = each.face.color;
        gl_.Uniform4f(shader["flat_color"], color.r / 255.0f, color.g / 255.0f, color.b / 255.0f, 1.0f);
      }
      gl_.BindVertexArray(array_);
      gl_.DrawArrays(GL_TRIANGLES, each.first, each.count);
    }
  }

  ShaderProgram& program(bool textured) {
    std::unique_ptr<ShaderProgram>& shader = textured ? textured_ : plain_;
    if (!shader) {
      shader = std::make_unique<ShaderProgram>(gl_, textured ? "picture" : "flat", flatShader(textured));
    }
    return *shader;
  }

  const GlFunctions& gl_;
  GlStore& store_;
  std::unique_ptr<ShaderProgram> plain_, textured_;
  GLuint array_ = 0, buffer_ = 0;
  std::vector<float> vertices_;  // x y z s t
  std::vector<Face> faces_;
  double near_m_ = 0.0;
};

}  // namespace aras_visual_servo_sim
