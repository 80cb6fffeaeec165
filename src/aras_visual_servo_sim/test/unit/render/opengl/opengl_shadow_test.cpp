// Shadows: where they lie, of what, and when their maps are drawn anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "light_tools.hpp"
#include "render/opengl/gl/gl_context.hpp"
#include "render/opengl/scene/gl_store.hpp"

namespace aras_visual_servo_sim::testing::opengl_shadow_test {
namespace {

TEST(OpenGlShadow, ShadowsLieWhereTheLightIsHidden) {
  for (const Light::Type type : {Light::Type::kDirectional, Light::Type::kSpot, Light::Type::kPoint}) {
    Light light = lamp(type, 0.8);
    light.direction_W = {1.0, 0.0, -1.0};
    light.position_W = {-2.0, 0.0, 2.0};
    light.inner_angle_rad = 1.0;
    light.outer_angle_rad = 1.2;
    Scene scene = floorUnder({light});
    // Its shadow lies 0.3 to 0.4 m to the right of it.
    scene.bodies.push_back(solid("box", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, {-0.2, 0.0, 0.35}));
    const int shadow = greyAt(scene, 0.15, 0.0), lit = greyAt(scene, 0.5, 0.0);
    EXPECT_NEAR(shadow, 25.5, kRounding);
    EXPECT_GT(lit, 150);
    scene.lighting.shadows = false;
    EXPECT_GT(greyAt(scene, 0.15, 0.0), 150);
  }
}

TEST(OpenGlShadow, ShadowEdgeIsSoftAndInItsPlace) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {1.0, 0.0, -1.0};
  Scene scene = floorUnder({sun});
  scene.lighting.shadow_map_px = 128;
  scene.bodies.push_back(solid("wall", makeBox({0.002, 1.0, 0.2}), {255, 0, 0}, {0.0, 0.0, 0.1}));
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, scene);
  // The wall is 0.2 m high: its shadow ends 0.2 m to its right. A texel is 1.0 m / 128 / cos(45 deg) there.
  const double texel_px = camera.fx() / 128.0 * std::sqrt(2.0);
  double sum = 0.0;
  for (int u = 180; u < 230; ++u) sum += (image.pixel(u, 120)[0] - 25.5) / (255.0 * 0.8 / std::sqrt(2.0));
  const double edge_px = 229.5 - sum, expected_px = camera.cx() + camera.fx() * 0.201;
  EXPECT_NEAR(edge_px, expected_px, 3.0 * texel_px + 1.0);
  bool soft = false;
  for (int u = 180; u < 230; ++u) soft = soft || (image.pixel(u, 120)[0] > 60 && image.pixel(u, 120)[0] < 140);
  EXPECT_TRUE(soft);
}

TEST(OpenGlShadow, LitSidesOfSolidsDoNotShadeThemselves) {
  Scene scene = colourfulScene();
  const Pose X_WC = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);
  scene.bodies.erase(scene.bodies.begin());  // nothing to throw shadows on but themselves
  const CameraModel camera(rgbConfig());
  Scene alone = scene;
  for (Body& body : alone.bodies) body.visible = &body == &alone.bodies[2];
  const Image without = renderOpenGl(camera, X_WC, alone);
  alone.lighting.shadows = true;
  const Difference difference = differenceOf(without, renderOpenGl(camera, X_WC, alone));
  EXPECT_LE(difference.inside, 6);  // of a ball: only where light grazes it
}

TEST(OpenGlShadow, WhatIsLitFromStraightAboveDoesNotShadeItself) {
  // Along the normal nothing but rounding would tell a surface from its own place in the map.
  for (const auto type : {Light::Type::kDirectional, Light::Type::kSpot, Light::Type::kPoint}) {
    Light light = lamp(type, 0.5);
    light.position_W = {0.0, 0.0, 3.0};
    light.inner_angle_rad = 1.0;
    light.outer_angle_rad = 1.2;
    Scene scene = floorUnder({light});
    scene.bodies[0].casts_shadows = true;
    for (int k = 0; k < 20; ++k) {
      const double height_m = 0.4 + 0.0137 * k;
      EXPECT_NEAR(greyAt(scene, 0.0, 0.0, lookingDown({0.001 * k, 0.002, height_m}, 0.01 * k)), 255 * 0.6, kRounding)
          << static_cast<int>(type) << ' ' << height_m;
    }
  }
}

TEST(OpenGlShadow, ShadowMapsAreDrawnAnewOnlyWhenSomethingMoved) {
  Scene scene = colourfulScene();
  scene.lighting.shadows = true;
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image image;
  const auto drawnAfter = [&](double camera_z) {
    renderer.render(camera, lookingDown({0.0, 0.0, camera_z}), scene, image);
    return renderer.statistics().shadow_maps;
  };
  EXPECT_EQ(drawnAfter(0.5), 1);
  EXPECT_EQ(drawnAfter(0.6), 1);
  scene.bodies[3].X_WB.p.x() += 0.01;
  EXPECT_EQ(drawnAfter(0.6), 2);
  scene.light_direction_W.x() += 0.1;
  EXPECT_EQ(drawnAfter(0.6), 3);
  const Image after = image;
  EXPECT_EQ(renderOpenGl(camera, lookingDown({0.0, 0.0, 0.6}), scene).data, after.data);
}

TEST(OpenGlShadow, PointLightsCastThemAllAround) {
  Light bulb = lamp(Light::Type::kPoint, 0.8);
  Scene scene;
  scene.lighting.ambient.setConstant(0.1);
  scene.lighting.lights = {bulb};
  scene.bodies.push_back(solid("room", makeSphere(1.0, 64), {255, 255, 255}, {0.0, 0.0, 0.0}));
  scene.bodies.back().shapes[0].material.two_sided = true;
  scene.bodies.back().casts_shadows = false;
  // The middles of a cube's faces, its edges and its corners, seen from its middle.
  std::vector<Eigen::Vector3d> ways;
  for (int k = 0; k < 27; ++k) {
    const Eigen::Vector3d way(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (k != 13) ways.push_back(way.normalized());
  }
  for (const Eigen::Vector3d& way : ways) {
    scene.bodies.push_back(solid("ball", makeSphere(0.05, 32), {255, 0, 0}, 0.5 * way));
    const Eigen::Vector3d beside = way.unitOrthogonal();
    EXPECT_NEAR(greySeen(scene, 0.5 * beside, 0.97 * way), 25.5, kRounding) << way.transpose();
    EXPECT_GT(greySeen(scene, 0.5 * beside, way + 0.3 * beside), 150) << way.transpose();
    scene.bodies.pop_back();
  }
}

TEST(OpenGlShadow, ScenesThatShowTheSameShareTheirMaps) {
  Scene scene = colourfulScene();
  scene.lighting.shadows = true;
  Scene other = scene;
  std::reverse(other.bodies.begin(), other.bodies.end());
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image image, expected;
  const Pose X_WC = lookingDown({0.0, 0.0, 0.5});
  for (int tick = 1; tick <= 3; ++tick) {
    scene.bodies[3].X_WB.p.x() += 0.01;
    other.bodies[other.bodies.size() - 4].X_WB.p.x() = scene.bodies[3].X_WB.p.x() + 1e-15;  // worked out another way
    renderer.render(camera, X_WC, scene, expected);
    renderer.render(camera, X_WC, other, image);
    EXPECT_EQ(renderer.statistics().shadow_maps, tick);
  }
  EXPECT_EQ(image.data, renderOpenGl(camera, X_WC, other).data);
}

TEST(OpenGlShadow, ScenesThatShowOtherThingsKeepMapsOfTheirOwn) {
  Scene scene = colourfulScene(), other = scene;
  scene.lighting.shadows = other.lighting.shadows = true;
  other.bodies[3].X_WB.p.x() += 0.01;
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image image;
  for (int k = 0; k < 3; ++k) {
    for (const Scene* each : {&scene, &other}) {
      renderer.render(camera, kAbove, *each, image);
      EXPECT_EQ(image.data, renderOpenGl(camera, kAbove, *each).data);
    }
  }
  EXPECT_EQ(renderer.statistics().shadow_maps, 2);
}

TEST(OpenGlShadow, OnlyWhatCanShadeWhatACameraSeesIsInItsMap) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {1.0, 0.0, -1.0};
  Scene scene = floorUnder({sun});
  for (int k = 0; k < 5; ++k) {  // 0.5 m apart; seen from 0.5 m above is half of that
    scene.bodies.push_back(solid("box", makeBox({0.05, 0.05, 0.05}), {255, 0, 0}, {-1.0 + 0.5 * k, 0.0, 0.1}));
  }
  constexpr long kBox = 12;  // triangles
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image image;
  const auto trianglesAfter = [&](const Pose& X_WC) {
    renderer.render(camera, X_WC, scene, image);
    EXPECT_EQ(image.data, renderOpenGl(camera, X_WC, scene).data);
    return renderer.statistics().shadow_triangles;
  };
  const Pose up{{0.0, 0.0, 0.5}, Eigen::Quaterniond::Identity()};
  EXPECT_EQ(trianglesAfter(up), 0);
  EXPECT_EQ(renderer.statistics().shadow_maps, 0);  // what sees nothing needs none
  EXPECT_EQ(trianglesAfter(lookingDown({0.0, 0.0, 0.25})), kBox);
  EXPECT_EQ(trianglesAfter(lookingDown({0.0, 0.0, 0.25})), kBox);
  EXPECT_EQ(trianglesAfter(lookingDown({0.5, 0.0, 0.25})), 2 * kBox);  // one more into the same map
  EXPECT_EQ(trianglesAfter(kAbove), 4 * kBox);  // with the one to the left that throws its shadow into view, or not
  EXPECT_EQ(renderer.statistics().shadow_maps, 1);
  scene.bodies.back().X_WB.p.y() += 0.01;
  EXPECT_EQ(trianglesAfter(lookingDown({0.0, 0.0, 0.25})), 5 * kBox);
  EXPECT_EQ(renderer.statistics().shadow_maps, 2);
}

TEST(OpenGlShadow, FineThingsCastShadowsOfFewerTriangles) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {1.0, 0.3, -1.0};
  Scene scene = floorUnder({sun});
  scene.lighting.shadow_map_px = 128;
  const MeshPtr fine = makeSphere(0.1, 256);
  scene.bodies.push_back(solid("ball", fine, {255, 0, 0}, {-0.3, -0.1, 0.3}));
  scene.bodies.push_back(solid("far", makeBox({0.01, 0.01, 0.01}), {255, 0, 0}, {0.3, 0.1, 0.005}));
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image coarse, exact;
  const auto shadowOf = [&](Image& image) {
    renderer.render(camera, kAbove, scene, image);
    Blob blob;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 150; u < image.width; ++u) {  // what is dark is the floor, for the ball is red
        const double dark = image.pixel(u, v)[2] > 0 ? (169.0 - image.pixel(u, v)[0]) / 143.5 : 0.0;
        blob.area += dark;
        blob.centroid += dark * Eigen::Vector2d(u, v);
      }
    }
    blob.centroid /= blob.area;
    return blob;
  };
  const Blob found = shadowOf(coarse);
  scene.lighting.shadow_map_px = 4096;
  const Blob expected = shadowOf(exact);
  ASSERT_GT(expected.area, 500.0);
  const double texel_px = camera.fx() * 1.0 / 128.0;
  EXPECT_LT((found.centroid - expected.centroid).norm(), texel_px);
  EXPECT_NEAR(std::sqrt(found.area / M_PI), std::sqrt(expected.area / M_PI), 1.5 * texel_px);
}

TEST(OpenGlShadow, TheFartherAPointMayBeOffTheFewerTrianglesAreLeft) {
  const std::unique_ptr<GlContext> context = makeOsmesaContext();
  const GlContext::Binding binding(*context);
  GlStore store(context->gl());
  const MeshPtr fine = makeSphere(0.1, 256);
  const auto indicesFor = [&](double error_m) { return std::size_t(store.outline(fine, error_m).index_count); };
  EXPECT_EQ(indicesFor(1e-6), 3 * fine->triangles.size());
  EXPECT_LT(indicesFor(0.005), 2 * fine->triangles.size());  // of three each
  EXPECT_LT(indicesFor(0.02), indicesFor(0.005) / 4);
  EXPECT_GT(indicesFor(0.02), 0u);
  const MeshPtr box = makeBox({0.1, 0.1, 0.1});
  EXPECT_EQ(store.outline(box, 0.05).index_count, 36);
}

TEST(OpenGlShadow, WhatALightDoesNotReachIsNotInItsMap) {
  for (const Light::Type type : {Light::Type::kSpot, Light::Type::kPoint}) {
    Light light = lamp(type, 0.8);
    light.position_W = {0.0, 0.0, 1.0};
    light.inner_angle_rad = 0.5;
    light.outer_angle_rad = 0.6;
    light.range_m = 1.5;
    Scene scene = floorUnder({light});
    scene.bodies.push_back(solid("near", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, {0.1, 0.0, 0.3}));
    scene.bodies.push_back(solid("away", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, {1.9, 0.0, 0.3}));
    const CameraModel camera(rgbConfig());
    OpenGlRenderer renderer;
    Image image;
    renderer.render(camera, kAbove, scene, image);
    EXPECT_EQ(renderer.statistics().shadow_maps, 1);
    scene.bodies[2].X_WB.p.x() += 0.02;
    renderer.render(camera, kAbove, scene, image);
    EXPECT_EQ(renderer.statistics().shadow_maps, 1);
    scene.bodies[1].X_WB.p.x() += 0.02;
    renderer.render(camera, kAbove, scene, image);
    EXPECT_EQ(renderer.statistics().shadow_maps, 2);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_shadow_test
