// Which meshes are one and the same to whoever draws many scenes.
#include <gtest/gtest.h>

#include <functional>

#include "scene/mesh/mesh_cache.hpp"

namespace aras_visual_servo_sim::shared_meshes_test {
namespace {

TexturePtr picture(const std::string& name, int width, int height, std::uint8_t level) {
  return std::make_shared<Texture>(name, width, height, std::vector<std::uint8_t>(3 * width * height, level));
}

/** A ball with a picture on it; all its numbers its own. */
std::shared_ptr<TriangleMesh> ball() {
  auto mesh = std::make_shared<TriangleMesh>(*makeSphere(0.25, 8));
  mesh->colors.assign(mesh->points.size(), Rgb{1, 2, 3});
  mesh->pictures = {{picture("stone", 2, 1, 7), Wrap::kRepeat, Wrap::kRepeat, picture("bumps", 1, 1, 9)}};
  mesh->picture_of.assign(mesh->triangles.size(), 0);
  return mesh;
}

TEST(SharedMeshes, AreThoseOfTheSameContent) {
  const MeshPtr first = shared(ball());
  EXPECT_EQ(shared(ball()), first);
  EXPECT_EQ(shared(first), first);
}

TEST(SharedMeshes, ThatDifferInAnythingAreTwo) {
  const MeshPtr first = shared(ball());
  const std::vector<std::function<void(TriangleMesh&)>> changes = {
      [](TriangleMesh& mesh) { mesh.points[0] *= 1.5f; },
      [](TriangleMesh& mesh) { mesh.normals[0] = -mesh.normals[0]; },
      [](TriangleMesh& mesh) { mesh.colors[0].g = 9; },
      [](TriangleMesh& mesh) { mesh.texture_coordinates[0].x() += 0.5f; },
      [](TriangleMesh& mesh) { std::swap(mesh.triangles[0], mesh.triangles[1]); },
      [](TriangleMesh& mesh) { mesh.picture_of[0] = -1; },
      [](TriangleMesh& mesh) { mesh.round.reset(); },
      [](TriangleMesh& mesh) { mesh.round->kind = RoundShape::Kind::kCylinder; },
      [](TriangleMesh& mesh) { mesh.round->radius_m = 0.5; },
      [](TriangleMesh& mesh) { mesh.round->length_m = 0.5; },
      [](TriangleMesh& mesh) { mesh.pictures.clear(); },
      [](TriangleMesh& mesh) { mesh.pictures[0].wrap_s = Wrap::kClamp; },
      [](TriangleMesh& mesh) { mesh.pictures[0].wrap_t = Wrap::kMirror; },
      [](TriangleMesh& mesh) { mesh.pictures[0].normals = nullptr; },
      [](TriangleMesh& mesh) { mesh.pictures[0].texture = picture("wood", 2, 1, 7); },
      [](TriangleMesh& mesh) { mesh.pictures[0].texture = picture("stone", 1, 1, 7); },
      [](TriangleMesh& mesh) { mesh.pictures[0].texture = picture("stone", 2, 2, 7); },
      [](TriangleMesh& mesh) { mesh.pictures[0].texture = picture("stone", 2, 1, 8); }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const auto other = ball();
    changes[k](*other);
    EXPECT_NE(shared(other), first) << "change " << k;
  }
}

TEST(SharedMeshes, ThatAreInUseStaySharedWhenManyOthersHaveGone) {
  const MeshPtr first = shared(ball());
  for (int k = 1; k <= 300; ++k) shared(makeBox({0.001 * k, 0.1, 0.1}));
  EXPECT_EQ(shared(ball()), first);
}

}  // namespace
}  // namespace aras_visual_servo_sim::shared_meshes_test
