// What is left out because it cannot be seen: shadows where there can be none, and the far sides of what casts them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "light_tools.hpp"
#include "render/opengl/scene/shadow/shadow_reach.hpp"

namespace aras_visual_servo_sim::testing::opengl_reach_test {
namespace {

/** A square floor of n x n squares. So many triangles that a body has it all drawn with shadows, for n = 32. */
MeshPtr tiles(int n) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (int k = 0; k < (n + 1) * (n + 1); ++k) {
    mesh->points.emplace_back(4.0f * float(k % (n + 1)) / float(n) - 2.0f, 4.0f * float(k / (n + 1)) / float(n) - 2.0f,
                              0.0f);
  }
  mesh->normals.assign(mesh->points.size(), Eigen::Vector3f::UnitZ());
  for (int k = 0; k < n * n; ++k) {
    const auto a = static_cast<std::uint32_t>(k / n * (n + 1) + k % n), b = a + static_cast<std::uint32_t>(n) + 1;
    mesh->triangles.push_back({a, a + 1, b + 1});
    mesh->triangles.push_back({a, b + 1, b});
  }
  mesh->finish();
  return mesh;
}

TEST(OpenGlReach, AFloorDrawnInPartsLooksAsOneDrawnAsAWhole) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 0.3, -1),
                                           Eigen::Vector3d(-0.5, 1.2, -0.7), Eigen::Vector3d(2, -2, -1)}) {
    for (const Pose& X_WC :
         {kAbove, lookingDown({0.1, 0.0, 0.9}, 0.2, -0.2, 0.4), lookingDown({0.0, 0.0, 0.9}, -0.3)}) {
      Light sun = lamp(Light::Type::kDirectional, 0.8);
      sun.direction_W = direction;
      Scene scene = floorUnder({sun});
      scene.lighting.shadow_map_px = 256;
      scene.bodies.push_back(solid("box", makeBox({0.1, 0.02, 0.06}), {255, 0, 0}, {0.1, -0.05, 0.12}, {0.3, 0.2, 1}));
      const CameraModel camera(rgbConfig());
      scene.bodies[0].shapes[0].mesh = tiles(1);
      const Image in_parts = renderOpenGl(camera, X_WC, scene);
      scene.bodies[0].shapes[0].mesh = tiles(32);
      const Image whole = renderOpenGl(camera, X_WC, scene);
      scene.lighting.shadows = false;
      const Image unshaded = renderOpenGl(camera, X_WC, scene);
      int apart = 0, in_shadow = 0;
      for (std::size_t k = 0; k < whole.data.size(); ++k) {
        apart = std::max(apart, std::abs(int(whole.data[k]) - int(in_parts.data[k])));
        in_shadow += unshaded.data[k] > whole.data[k] + 30;
      }
      EXPECT_LE(apart, kRounding + 1.0);  // rounding of the places on the map, at the edge of a shadow
      EXPECT_GT(in_shadow, 30);
    }
  }
}

TEST(OpenGlReach, ThePartIsSmallWhereTheShadowIs) {
  const CameraModel camera(rgbConfig());
  const PinholeView view = PinholeView::of(camera);
  // The map's coordinates are 10 x - 1, 10 y - 1, 1 - z: it shows x and y from 0.1 to 0.2 and light that shines down.
  Eigen::Matrix4d of_world = Eigen::Matrix4d::Identity();
  of_world.diagonal() << 10.0, 10.0, -1.0, 1.0;
  of_world.col(3) << -1.0, -1.0, 1.0, 1.0;
  MapBox caster;  // as wide as the map, up to z = 0.5
  caster.add({0.0, 0.0, 0.5});
  caster.add(Eigen::Vector3d::Ones());
  const Eigen::Matrix4d X_CW = kAbove.inverse().matrix(), of_camera = of_world * kAbove.matrix();
  const auto seenAt = [&](double x, double z) {
    const Eigen::Matrix4d X_WS = Eigen::Affine3d(Eigen::Translation3d(x, 0.0, z)).matrix();
    return SeenMesh(*tiles(1), X_CW * X_WS, of_camera, view);
  };
  const PixelBox part = seenAt(0.0, 0.0).shadowOf(caster, camera.nearM());
  const Eigen::Vector2d a = *camera.project(kAbove.inverse() * Eigen::Vector3d(0.1, 0.1, 0.0));
  const Eigen::Vector2d b = *camera.project(kAbove.inverse() * Eigen::Vector3d(0.2, 0.2, 0.0));
  constexpr double kRim = 4.0;  // [px]: two about the part, two for whole pixels
  EXPECT_NEAR(part.u0, std::min(a.x(), b.x()), kRim);
  EXPECT_NEAR(part.u1, std::max(a.x(), b.x()), kRim);
  EXPECT_NEAR(part.v0, std::min(a.y(), b.y()), kRim);
  EXPECT_NEAR(part.v1, std::max(a.y(), b.y()), kRim);
  EXPECT_TRUE(seenAt(0.0, 0.3).box().meets(caster));
  EXPECT_FALSE(seenAt(0.0, 0.7).box().meets(caster));  // above all that casts
  EXPECT_TRUE(seenAt(0.0, 0.7).shadowOf(caster, camera.nearM()).empty());
  EXPECT_TRUE(seenAt(2.5, 0.0).shadowOf(caster, camera.nearM()).empty());  // beside it
  EXPECT_FALSE(seenAt(2.5, 0.0).box().meets(caster));
}

TEST(OpenGlReach, ABoxOnTheMapHoldsWhatIsSeenAndNoMore) {
  const CameraModel camera(rgbConfig());
  const PinholeView view = PinholeView::of(camera);
  const Eigen::Matrix4d X_CW = kAbove.inverse().matrix();  // on the map are x, y and z of the world
  const MapBox box = SeenMesh(*tiles(1), X_CW, kAbove.matrix(), view).box();
  const double half_x = 0.5 * camera.width() / camera.fx(), half_y = 0.5 * camera.height() / camera.fy();
  const double rim = 3.0 / camera.fx();
  EXPECT_NEAR(box.high.x(), half_x, rim);
  EXPECT_NEAR(box.low.x(), -half_x, rim);
  EXPECT_NEAR(box.high.y(), half_y, rim);
  EXPECT_NEAR(box.low.y(), -half_y, rim);
  EXPECT_NEAR(box.high.z(), 0.0, 1e-6);
  EXPECT_GE(box.high.x(), half_x);
  const Eigen::Matrix4d behind = X_CW * Eigen::Affine3d(Eigen::Translation3d(0.0, 0.0, 1.1)).matrix();
  EXPECT_TRUE(SeenMesh(*tiles(1), behind, kAbove.matrix(), view).box().empty());
  // From inside a box its inner space counts too, up to the eye.
  const Eigen::Matrix4d about = X_CW * Eigen::Affine3d(Eigen::Translation3d(0.0, 0.0, 0.9)).matrix();
  EXPECT_NEAR(SeenMesh(*makeBox({3.0, 3.0, 0.4}), about, kAbove.matrix(), view).box().high.z(), 1.0, 1e-6);
}

TEST(OpenGlReach, OpenMeshesCastShadowsFromBothTheirSides) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {1.0, 0.0, -1.0};
  for (const double turned : {0.0, M_PI}) {
    Scene scene = floorUnder({sun});
    auto sheet = std::make_shared<TriangleMesh>();
    sheet->points = {{-0.05f, -0.05f, 0}, {0.05f, -0.05f, 0}, {0.05f, 0.05f, 0}, {-0.05f, 0.05f, 0}};
    sheet->normals.assign(4, Eigen::Vector3f::UnitZ());
    sheet->triangles = {{0, 1, 2}, {0, 2, 3}};
    sheet->finish();
    scene.bodies.push_back(solid("sheet", sheet, {255, 0, 0}, {-0.2, 0.0, 0.35}, {turned, 0.0, 0.0}));
    scene.bodies.push_back(solid("box", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, {-0.2, 0.3, 0.35}, {turned, 0.0, 0.0}));
    EXPECT_NEAR(greyAt(scene, 0.15, 0.0), 25.5, kRounding);
    EXPECT_NEAR(greyAt(scene, 0.15, 0.3), 25.5, kRounding);
    EXPECT_GT(greyAt(scene, 0.4, 0.0), 150);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_reach_test
