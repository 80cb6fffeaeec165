// Solids against OpenGL: a black scene on white, projected here and drawn by OSMesa with 8 x 8 pixels for one.
#include <gtest/gtest.h>

#include <cmath>

#include "osmesa_canvas.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing {
namespace {

constexpr int kFine = 8;

/** Black solids, through and beside each other and a grey plate. Black stays black in any light. */
Scene blackScene() {
  Scene scene;
  scene.background = {255, 255, 255};
  scene.models.emplace_back("plate", std::vector<Polygon>{{{-0.1, -0.08}, {0.12, -0.08}, {0.12, 0.08}, {-0.1, 0.08}}},
                            Rgb{128, 128, 128});
  for (int i = 0; i < 8; ++i) {
    Body body;
    body.name = std::to_string(i);
    const MeshPtr mesh = i % 3 == 0   ? makeBox({0.05, 0.03, 0.04})
                         : i % 3 == 1 ? makeCylinder(0.015, 0.09)
                                      : makeSphere(0.025);
    body.shapes.push_back({Pose{}, mesh, {0, 0, 0}});
    body.X_WB.p = Eigen::Vector3d(0.07 * (i % 4) - 0.1, 0.09 * (i / 4) - 0.05, 0.02 * (i % 3) - 0.015);
    body.X_WB.q = Eigen::AngleAxisd(0.5 * i, Eigen::Vector3d(1, 2, 0.5).normalized());
    scene.bodies.push_back(body);
  }
  return scene;
}

class Projected {
 public:
  Projected(const CameraModel& camera, const Pose& X_CW) : camera_(camera), X_CW_(X_CW) {}

  void add(const Eigen::Vector3d& p_W, std::uint8_t grey) {
    const Eigen::Vector3d p_C = X_CW_ * p_W;
    const Eigen::Vector2d px = *camera_.project(p_C);
    vertices.push_back({static_cast<float>(kFine * (px.x() + 0.5)),
                        static_cast<float>(kFine * (px.y() + 0.5)),
                        static_cast<float>(camera_.nearM() / p_C.z()),
                        {grey, grey, grey, 255}});
  }

  std::vector<GlVertex> vertices;

 private:
  const CameraModel& camera_;
  Pose X_CW_;
};

std::vector<GlVertex> project(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  Projected projected(camera, X_WC.inverse());
  for (const PlanarModel& model : scene.models) {
    for (const auto& triangle : model.triangles(0)) {
      for (const std::uint32_t k : triangle) {
        const Eigen::Vector2d& p = model.outlines()[0][k];
        projected.add(model.X_WM * Eigen::Vector3d(p.x(), p.y(), 0.0), 128);
      }
    }
  }
  for (const Body& body : scene.bodies) {
    const TriangleMesh& mesh = *body.shapes[0].mesh;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t k : triangle) projected.add(body.X_WB * mesh.points[k].cast<double>(), 0);
    }
  }
  return projected.vertices;
}

TEST(OpenGl, DrawsTheSameSolids) {
  const CameraModel camera(cameraConfig());
  const Scene scene = blackScene();
  const Pose X_WC = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);
  const Image image = render(camera, X_WC, scene);
  OsmesaCanvas canvas(kFine * camera.width(), kFine * camera.height());
  const std::uint32_t* fine = canvas.draw(project(camera, X_WC, scene), scene.background);
  double sum = 0.0;
  int worst = 0, edges = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      int grey = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        grey += fine[std::size_t(kFine * v + k / kFine) * canvas.width() + kFine * u + k % kFine] & 0xff;
      }
      const int difference = int(*image.pixel(u, v)) - (grey + 32) / 64;
      edges += grey > 0 && grey < 64 * 255 && grey != 64 * 128;
      worst = std::max(worst, std::abs(difference));
      sum += difference;
    }
  }
  ASSERT_GT(edges, 500);
  // One straight edge is off by 1/16 of a pixel at most in either pattern; two meet in a corner.
  constexpr double kSampling = 2.0 * (1.0 / 16.0 + 1.0 / 16.0) * 255.0;
  EXPECT_LE(worst, kSampling);
  // Over all edge pixels these errors cancel: 1/16/sqrt(3) each, both patterns, four standard deviations.
  EXPECT_LE(std::abs(sum), 4.0 * 255.0 * 0.036 * std::sqrt(2.0 * edges));
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing
