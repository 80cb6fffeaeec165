// Pictures on meshes: files written here, held against the picture of a planar model, which is drawn by other code.
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/folder_fixture.hpp"
#include "tools/messages.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::mesh_picture_test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 48, kHeight = 32;

/** Blocks of many colours, no two corners alike. */
std::vector<std::uint8_t> blocks() {
  std::vector<std::uint8_t> rgb;
  for (int j = 0; j < kHeight; ++j) {
    for (int i = 0; i < kWidth; ++i) {
      const int block = i / 4 * 7 + j / 4 * 3;
      for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<std::uint8_t>((block * (31 + 22 * c)) % 256));
    }
  }
  return rgb;
}

class MeshPicture : public FolderFixture {
 protected:
  void SetUp() override {
    FolderFixture::SetUp();
    stbi_write_png(path("blocks.png").c_str(), kWidth, kHeight, 3, blocks().data(), 3 * kWidth);
  }
  /** A rectangle 0.3 m x 0.2 m in z = 0, seen from +z, the picture on it `repeat` times each way. */
  std::string rectangleObj(double repeat, const std::string& picture = "blocks.png",
                           const char* color = "1 1 1") const {
    write("plate.mtl", std::string("newmtl m\nKd ") + color + "\nmap_Kd " + picture + "\n");
    const std::string r = std::to_string(repeat);
    return write("plate.obj",
                 "mtllib plate.mtl\nv -0.15 -0.1 0\nv 0.15 -0.1 0\nv 0.15 0.1 0\nv -0.15 0.1 0\nvt 0 0\nvt " + r +
                     " 0\nvt " + r + " " + r + "\nvt 0 " + r +
                     "\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n");
  }
};

CameraConfig colorConfig(const CameraConfig& from) {
  CameraConfig config = from;
  config.encoding = "rgb8";
  return config;
}

Scene sceneOf(const MeshPtr& mesh) {
  Scene scene;
  Body body;
  body.name = "plate";
  body.shapes.push_back({Pose{}, mesh, {255, 255, 255}});
  scene.bodies.push_back(body);
  return scene;
}

/** The picture without its light, which is that of the same mesh in white. */
Image unlit(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  Scene white = scene;
  for (Body& body : white.bodies) {
    for (Shape& shape : body.shapes) {
      auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
      mesh->colors.clear();
      mesh->pictures.clear();
      mesh->picture_of.clear();
      shape.mesh = mesh;
      shape.color = {255, 255, 255};
    }
  }
  const Image light = render(camera, X_WC, white);
  Image image = render(camera, X_WC, scene);
  for (std::size_t k = 0; k < image.data.size(); ++k) {
    image.data[k] =
        static_cast<std::uint8_t>(std::min(255.0, 255.0 * image.data[k] / std::max(1, int(light.data[k])) + 0.5));
  }
  return image;
}

Scene pictureScene(const std::vector<std::uint8_t>& rgb, int width, int height) {
  Scene scene;
  scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{std::make_shared<Texture>("photo", width, height, rgb), {0.3, 0.2}});
  return scene;
}

/** Largest difference over the pixels that see nothing but the rectangle, and how many these are. */
std::pair<int, int> worstInside(const CameraModel& camera, const Pose& X_WC, const Image& a, const Image& b) {
  const auto inside = [&](double u, double v) {
    const Eigen::Vector3d ray_W = X_WC.q * camera.unproject(u, v);
    const Eigen::Vector3d p = X_WC.p - X_WC.p.z() / ray_W.z() * ray_W;
    return std::abs(p.x()) < 0.15 && std::abs(p.y()) < 0.1;
  };
  int worst = 0, count = 0;
  for (int v = 0; v < a.height; ++v) {
    for (int u = 0; u < a.width; ++u) {
      if (!inside(u - 0.6, v - 0.6) || !inside(u + 0.6, v - 0.6) || !inside(u - 0.6, v + 0.6) ||
          !inside(u + 0.6, v + 0.6)) {
        continue;
      }
      ++count;
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a.pixel(u, v)[c] - b.pixel(u, v)[c]));
    }
  }
  return {worst, count};
}

// Both round to 8 bits, the light divides once more: 0.5 + 0.5 / 0.38 levels at the darkest, and the planar path's
// straight edges and constant scale in each pixel differ from this one's by second-order terms of perspective and lens.
constexpr int kTwoRoundings = 3;
// Where the image's border cuts the rectangle its two triangles are sampled along their common edge: each one's share
// of such a pixel is a count of 64ths.
constexpr int kSeam = 255 / 64 + 1;

TEST_F(MeshPicture, OfAnObjIsWhatThePlanarPictureShows) {
  CameraConfig fisheye = cameraConfig();
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  const Scene mesh = sceneOf(loadMesh(rectangleObj(1.0)));
  const Scene planar = pictureScene(blocks(), kWidth, kHeight);
  for (const CameraConfig& config : {cameraConfig(), distortedConfig(), fisheye}) {
    SCOPED_TRACE(config.distortion_model);
    const CameraModel camera(colorConfig(config));
    for (const double distance : {0.25, 0.5, 2.0}) {
      const Pose X_WC = lookingDown({0.02, -0.03, distance}, 0.2, -0.25, 0.4);
      const auto [worst, count] = worstInside(camera, X_WC, unlit(camera, X_WC, mesh), render(camera, X_WC, planar));
      EXPECT_LE(worst, kTwoRoundings + (distance < 0.3 ? kSeam : 0)) << distance;
      EXPECT_GT(count, 200);
    }
  }
}

TEST_F(MeshPicture, RepeatsBeyondItsEdges) {
  std::vector<std::uint8_t> tiled;
  const std::vector<std::uint8_t> once = blocks();
  for (int j = 0; j < 3 * kHeight; ++j) {
    for (int i = 0; i < 3 * kWidth; ++i) {
      const std::uint8_t* texel = once.data() + 3 * (j % kHeight * kWidth + i % kWidth);
      tiled.insert(tiled.end(), texel, texel + 3);
    }
  }
  const CameraModel camera(colorConfig(distortedConfig()));
  const Pose X_WC = lookingDown({0.02, -0.03, 0.4}, 0.2, -0.25, 0.4);
  const Image image = unlit(camera, X_WC, sceneOf(loadMesh(rectangleObj(3.0))));
  const Image truth = render(camera, X_WC, pictureScene(tiled, 3 * kWidth, 3 * kHeight));
  EXPECT_LE(worstInside(camera, X_WC, image, truth).first, kTwoRoundings);
}

TEST_F(MeshPicture, HasItsTopAtTheTopAndIsNotMirrored) {
  const CameraModel camera(colorConfig(cameraConfig()));
  const Pose X_WC = lookingDown({0, 0, 0.3});
  const Image image = unlit(camera, X_WC, sceneOf(loadMesh(rectangleObj(1.0))));
  const std::vector<std::uint8_t> rgb = blocks();
  for (const auto& [x, y, i, j] : {std::tuple{-0.14, 0.09, 1, 1}, std::tuple{0.14, 0.09, 46, 1},
                                   std::tuple{-0.14, -0.09, 1, 30}, std::tuple{0.14, -0.09, 46, 30}}) {
    const Eigen::Vector2d px = *camera.project({x, -y, 0.3});
    const std::uint8_t* pixel = image.pixel(static_cast<int>(px.x() + 0.5), static_cast<int>(px.y() + 0.5));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], rgb[3 * (j * kWidth + i) + c], kTwoRoundings) << x << " " << y;
  }
}

TEST_F(MeshPicture, IsMultipliedByTheColourOfAnMtl) {
  const CameraModel camera(colorConfig(cameraConfig()));
  const Pose X_WC = lookingDown({0, 0, 0.3});
  const Image white = render(camera, X_WC, sceneOf(loadMesh(rectangleObj(1.0))));
  const Image half = render(camera, X_WC, sceneOf(loadMesh(rectangleObj(1.0, "blocks.png", "0.5 1 0"))));
  for (int u = 120; u < 200; u += 7) {
    const std::uint8_t *a = white.pixel(u, 120), *b = half.pixel(u, 120);
    EXPECT_NEAR(b[0], 0.5 * a[0], 1.0);
    EXPECT_EQ(b[1], a[1]);
    EXPECT_EQ(b[2], 0);
  }
}

/** Two triangles of a rectangle 0.3 m x 0.2 m, each of a material of its own: one pictured, one red. */
std::string twoMaterials(const std::string& picture, const std::string& wrap) {
  const std::string source =
      picture.empty() ? ""
                      : "<library_images><image id='i'><init_from>" + picture + "</init_from></image></library_images>";
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
         "<asset><unit meter='1'/><up_axis>Z_UP</up_axis></asset>" +
         source +
         "<library_effects><effect id='e1'><profile_COMMON>"
         "<newparam sid='f'><surface type='2D'><init_from>i</init_from></surface></newparam>"
         "<newparam sid='s'><sampler2D><source>f</source>" +
         wrap +
         "</sampler2D></newparam>"
         "<technique sid='c'><lambert><diffuse><texture texture='s' texcoord='UV'/></diffuse></lambert></technique>"
         "</profile_COMMON></effect><effect id='e2'><profile_COMMON><technique sid='c'><lambert><diffuse>"
         "<color>1 0 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>"
         "<library_materials><material id='m1' name='m1'><instance_effect url='#e1'/></material>"
         "<material id='m2' name='m2'><instance_effect url='#e2'/></material></library_materials>"
         "<library_geometries><geometry id='g'><mesh>"
         "<source id='p'><float_array id='pa' count='12'>-0.15 -0.1 0 0.15 -0.1 0 0.15 0.1 0 -0.15 0.1 0</float_array>"
         "<technique_common><accessor source='#pa' count='4' stride='3'><param name='X' type='float'/>"
         "<param name='Y' type='float'/><param name='Z' type='float'/></accessor></technique_common></source>"
         "<source id='t'><float_array id='ta' count='8'>0 0 2 0 2 2 0 2</float_array>"
         "<technique_common><accessor source='#ta' count='4' stride='2'><param name='S' type='float'/>"
         "<param name='T' type='float'/></accessor></technique_common></source>"
         "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
         "<triangles count='1' material='one'><input semantic='VERTEX' source='#v' offset='0'/>"
         "<input semantic='TEXCOORD' source='#t' offset='1' set='0'/><p>0 0 1 1 2 2</p></triangles>"
         "<triangles count='1' material='two'><input semantic='VERTEX' source='#v' offset='0'/>"
         "<input semantic='TEXCOORD' source='#t' offset='1' set='0'/><p>0 0 2 2 3 3</p></triangles>"
         "</mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id='s'><node><instance_geometry "
         "url='#g'><bind_material><technique_common>"
         "<instance_material symbol='one' target='#m1'><bind_vertex_input semantic='UV' input_semantic='TEXCOORD' "
         "input_set='0'/></instance_material><instance_material symbol='two' target='#m2'/></technique_common>"
         "</bind_material></instance_geometry></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

TEST_F(MeshPicture, OfADaeLiesOnTheTrianglesOfItsMaterialOnly) {
  const MeshPtr mesh = loadMesh(write("two.dae", twoMaterials("blocks.png", "")));
  ASSERT_EQ(mesh->pictures.size(), 1u);
  EXPECT_EQ(mesh->pictures[0].wrap_s, Wrap::kRepeat);
  EXPECT_EQ(std::count(mesh->picture_of.begin(), mesh->picture_of.end(), 0), 1);
  const CameraModel camera(colorConfig(cameraConfig()));
  const Pose X_WC = lookingDown({0, 0, 0.3});
  const Image image = unlit(camera, X_WC, sceneOf(mesh));
  const Eigen::Vector2d red = *camera.project({-0.1, -0.05, 0.3}), pictured = *camera.project({0.13, 0.08, 0.3});
  const std::uint8_t* pixel = image.pixel(static_cast<int>(red.x()), static_cast<int>(red.y()));
  EXPECT_EQ(pixel[0], 255);
  EXPECT_EQ(pixel[1], 0);
  // Texture coordinates (1.867, 0.2): s at 0.867 of the picture's width, t at 0.8 of its height.
  const std::vector<std::uint8_t> rgb = blocks();
  pixel = image.pixel(static_cast<int>(pictured.x() + 0.5), static_cast<int>(pictured.y() + 0.5));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], rgb[3 * (25 * kWidth + 41) + c], kTwoRoundings);
}

TEST_F(MeshPicture, ObeysWrapModes) {
  const CameraModel camera(colorConfig(cameraConfig()));
  const std::vector<std::uint8_t> rgb = blocks();
  const auto expectTexel = [&](const MeshPtr& mesh, double x, double y, int i, int j) {
    const Image image = unlit(camera, lookingDown({0, 0, 0.3}), sceneOf(mesh));
    const Eigen::Vector2d px = *camera.project({x, -y, 0.3});
    const std::uint8_t* pixel = image.pixel(static_cast<int>(px.x() + 0.5), static_cast<int>(px.y() + 0.5));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], rgb[3 * (j * kWidth + i) + c], kTwoRoundings) << x << " " << y;
  };
  const MeshPtr clamped = loadMesh(rectangleObj(2.0, "-clamp on blocks.png"));
  ASSERT_EQ(clamped->pictures.size(), 1u);
  EXPECT_EQ(clamped->pictures[0].wrap_s, Wrap::kClamp);
  expectTexel(clamped, -0.13, 0.03, 6, 0);    // (0.133, 1.3): the top row goes on
  expectTexel(clamped, 0.13, -0.04, 47, 12);  // (1.867, 0.6): the right column does
  TriangleMesh turned = *loadMesh(rectangleObj(2.0));
  turned.pictures[0].wrap_s = Wrap::kMirror;
  const auto mirrored = std::make_shared<const TriangleMesh>(turned);
  expectTexel(mirrored, 0.13, 0.01, 6, 29);  // (1.867, 1.1): turned to 0.133 of the width
}

TEST_F(MeshPicture, ThatIsMissingIsRefusedWithMeshPictureAndPlaces) {
  const std::string mesh = rectangleObj(1.0, "textures/gone.png");
  const std::string said = messageOf<ModelError>([&] { loadMesh(mesh); });
  EXPECT_HAS(said, mesh);
  EXPECT_HAS(said, "'textures/gone.png' not found");
  EXPECT_HAS(said, path("textures/gone.png"));
}

TEST_F(MeshPicture, IsFoundInPackagesAndInGazebosFolders) {
  fs::create_directories(folder_ / "model" / "meshes");
  fs::create_directories(folder_ / "model" / "materials" / "textures");
  fs::copy_file(path("blocks.png"), path("model/materials/textures/other.png"));
  fs::copy_file(rectangleObj(1.0, "C:\\\\work\\\\other.png"), path("model/meshes/plate.obj"));
  fs::copy_file(path("plate.mtl"), path("model/meshes/plate.mtl"));
  EXPECT_EQ(loadMesh(path("model/meshes/plate.obj"))->pictures[0].texture->width(), kWidth);
  write("package.xml", "<package/>");
  const PackagePaths packages({{"photos", folder_.string()}});
  const std::string named = rectangleObj(1.0, "package://photos/blocks.png");
  EXPECT_EQ(loadMesh(named, Eigen::Vector3d::Ones(), packages)->pictures[0].texture->width(), kWidth);
  EXPECT_EQ(packages.resolve("model://photos/blocks.png"), path("blocks.png"));
  EXPECT_THROW(packages.resolve("model://nowhere/blocks.png"), ModelError);
}

/** The front of a box in a URDF, its picture upright as seen from -y. */
TEST_F(MeshPicture, OfAUrdfsMaterialLiesOnABoxAsInGazebo) {
  const std::string urdf =
      "<robot name='r'><link name='crate'><visual><geometry><box size='0.3 0.1 0.2'/></geometry><material name='m'>"
      "<texture filename='file://" +
      path("blocks.png") + "'/></material></visual></link></robot>";
  Scene scene;
  addRobotBodies(loadRobotModel(urdf, "test"), PackagePaths(), scene);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const CameraModel camera(colorConfig(cameraConfig()));
  // From -y, x to the right and z up.
  Pose X_WC;
  X_WC.p = {0.0, -0.35, 0.0};
  X_WC.q = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX());
  const Image image = unlit(camera, X_WC, scene);
  // The planar picture in the place of that face.
  Scene planar = pictureScene(blocks(), kWidth, kHeight);
  planar.models[0].X_WM.p = {0.0, -0.05, 0.0};
  planar.models[0].X_WM.q = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  const Image truth = render(camera, X_WC, planar);
  int worst = 0;
  for (int v = 60; v < 180; ++v) {
    for (int u = 80; u < 240; ++u) {
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(image.pixel(u, v)[c] - truth.pixel(u, v)[c]));
    }
  }
  EXPECT_LE(worst, kTwoRoundings);
}

/** A floor seen along itself: no repetition of the picture is nearer to a pixel's size than any other. */
TEST_F(MeshPicture, FadesToItsMeanTowardsTheHorizon) {
  const TexturePtr texture = loadTexture(path("blocks.png"));
  auto floor = std::make_shared<TriangleMesh>(*withPicture(*makeBox({200, 200, 0.1}), texture));
  for (Eigen::Vector2f& point : floor->texture_coordinates) point *= 2000.0f;
  CameraConfig config = colorConfig(cameraConfig());
  config.far_m = 500.0;
  const CameraModel camera(config);
  Scene scene = sceneOf(floor);
  scene.bodies[0].X_WB.p = {0.0, 0.0, -0.05};
  for (const double height : {1e-9, 0.1}) {
    Pose X_WC;  // along +y, the horizon in the middle of the image
    X_WC.p = {0.0, 0.0, height};
    X_WC.q = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX());
    const Image image = unlit(camera, X_WC, scene);
    if (height < 0.01) continue;  // nothing to be seen, and nothing to go wrong
    const Rgb mean = texture->meanColor();
    constexpr double kRest = 12.0;  // [grey levels] of blocks half as wide as the pixel's longer side
    for (int u = 100; u < 220; ++u) {
      EXPECT_NEAR(image.pixel(u, 122)[0], mean.r, kRest);
      EXPECT_NEAR(image.pixel(u, 122)[1], mean.g, kRest);
    }
  }
}

TEST_F(MeshPicture, LiesAsItsTransformSays) {
  const TexturePtr texture = loadTexture(path("blocks.png"));
  TextureTransform twice;  // two pictures each way, one of them in the middle
  twice << 2.0, 0.0, -0.5, 0.0, 2.0, -0.5;
  for (const MeshPtr& mesh : {makeBox({0.3, 0.2, 0.1}), makeSphere(0.1)}) {
    const MeshPtr plain = withPicture(*mesh, texture), more = withPicture(*mesh, texture, twice);
    for (std::size_t i = 0; i < mesh->points.size(); ++i) {
      const Eigen::Vector2f expected = 2.0f * plain->texture_coordinates[i] - Eigen::Vector2f::Constant(0.5f);
      EXPECT_TRUE(more->texture_coordinates[i].isApprox(expected, 1e-6f)) << i;
    }
    EXPECT_FALSE(more->round) << "whose picture lies as its equation says";
    EXPECT_EQ(plain->round.has_value(), mesh->round.has_value());
  }
}

TEST_F(MeshPicture, OfAUrdfsMaterialNeedsTextureCoordinates) {
  TriangleMesh mesh;
  mesh.points.emplace_back(0.0f, 0.0f, 0.0f);
  EXPECT_THROW(withPicture(mesh, loadTexture(path("blocks.png"))), ModelError);
}

TEST_F(MeshPicture, GoesRoundCylindersAndSpheresWithoutMirroring) {
  // Seen from outside, s x t (right x down) points inwards everywhere but on caps' middles and poles.
  for (const MeshPtr& mesh : {makeCylinder(0.1, 0.2), makeSphere(0.1), makeBox({0.1, 0.2, 0.3})}) {
    for (const auto& [i, j, k] : mesh->triangles) {
      const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const Eigen::Vector2f p = mesh->texture_coordinates[b] - mesh->texture_coordinates[a],
                              q = mesh->texture_coordinates[c] - mesh->texture_coordinates[a];
        return p.x() * q.y() - q.x() * p.y();
      };
      EXPECT_LT(turn(i, j, k), 0.0f);  // counter-clockwise outside is clockwise in (s, t), t down
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::mesh_picture_test
