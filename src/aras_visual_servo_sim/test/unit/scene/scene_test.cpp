#include "aras_visual_servo_sim/scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/folder_fixture.hpp"
#include "tools/messages.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::scene_test {
namespace {

class SceneFiles : public FolderFixture {};

/** A tetrahedron of legs 1, 2, 3 along x, y, z, faces outwards, in three formats. */
constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr const char* kStl = R"(solid t
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 2 0
vertex 1 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 3
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 3
vertex 0 2 0
endloop
endfacet
facet normal 0.857 0.429 0.286
outer loop
vertex 1 0 0
vertex 0 2 0
vertex 0 0 3
endloop
endfacet
endsolid t
)";
constexpr const char* kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>1 0.5 0 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4" material="s"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";

/** Six times the volume inside: positive when all faces look outwards. */
double volumeOf(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.points[a].cast<double>().dot(mesh.points[b].cast<double>().cross(mesh.points[c].cast<double>()));
  }
  return volume / 6.0;
}

constexpr double kFloat = 1e-5;  // meshes hold single precision, a few eps of 3

TEST_F(SceneFiles, StlDaeAndObjGiveTheSameTetrahedron) {
  for (const auto& [name, text] : {std::pair{"t.obj", kObj}, {"t.stl", kStl}, {"t.dae", kDae}}) {
    SCOPED_TRACE(name);
    const MeshPtr mesh = loadMesh(write(name, text));
    EXPECT_EQ(mesh->triangles.size(), 4u);
    EXPECT_NEAR(volumeOf(*mesh), 1.0, kFloat);
    EXPECT_LT((mesh->box_max - Eigen::Vector3f(1, 2, 3)).norm(), kFloat);
    EXPECT_EQ(mesh->normals.size(), mesh->points.size());
    for (const Eigen::Vector3f& normal : mesh->normals) EXPECT_NEAR(normal.norm(), 1.0, kFloat);
  }
}

TEST_F(SceneFiles, DaeKeepsItsColourAndStlHasNone) {
  const MeshPtr dae = loadMesh(write("t.dae", kDae));
  ASSERT_EQ(dae->colors.size(), dae->points.size());
  EXPECT_EQ(dae->colors[0], (Rgb{255, 128, 0}));
  EXPECT_TRUE(loadMesh(write("t.stl", kStl))->colors.empty());
}

TEST_F(SceneFiles, MeshScaleStretchesAndMirroringKeepsFacesOutside) {
  const std::string path = write("t.obj", kObj);
  EXPECT_NEAR(volumeOf(*loadMesh(path, {2, 0.5, 3})), 3.0, kFloat);
  EXPECT_NEAR(volumeOf(*loadMesh(path, {-1, 1, 1})), 1.0, kFloat);
  EXPECT_THROW(loadMesh(path, {0, 1, 1}), ModelError);
}

TEST_F(SceneFiles, MissingBrokenAndEmptyMeshesAreNamed) {
  for (const std::string& file : {path("none.stl"), write("broken.dae", "<COLLADA"), write("e.obj", "v 0 0 0\n")}) {
    EXPECT_HAS(messageOf<ModelError>([&] { loadMesh(file); }), file);
  }
}

TEST(Scene, ScenesShareMeshesWithTheSameContent) {
  const auto meshOf = [](const std::string& shape) {
    const std::string urdf =
        "<robot name='r'><link name='l'><visual><geometry>" + shape + "</geometry></visual></link></robot>";
    return bodyFromUrdf("body", urdf, PackagePaths{}, nullptr).shapes.at(0).mesh;
  };
  const MeshPtr box = meshOf("<box size='0.1 0.2 0.3'/>"), ball = meshOf("<sphere radius='0.1'/>");
  EXPECT_EQ(meshOf("<box size='0.1 0.2 0.3'/>"), box);
  EXPECT_EQ(meshOf("<sphere radius='0.1'/>"), ball);
  EXPECT_NE(meshOf("<box size='0.1 0.2 0.300001'/>"), box);
  EXPECT_NE(meshOf("<sphere radius='0.2'/>"), ball);
}

TEST(Primitives, AreClosedAndFaceOutwards) {
  EXPECT_NEAR(volumeOf(*makeBox({1, 2, 3})), 6.0, kFloat);
  constexpr double kFacets = 0.02;  // 32 corners enclose 0.6 % less than a circle; a ball more so
  EXPECT_NEAR(volumeOf(*makeCylinder(1.0, 2.0)), 2 * M_PI, kFacets * 2 * M_PI);
  EXPECT_NEAR(volumeOf(*makeSphere(1.0)), 4 * M_PI / 3, kFacets * 4 * M_PI / 3);
  EXPECT_THROW(makeBox({1, 0, 1}), ModelError);
  EXPECT_THROW(makeCylinder(-1, 1), ModelError);
  EXPECT_THROW(makeSphere(std::nan("")), ModelError);
}

TEST_F(SceneFiles, PackagesAreFoundInTheMapAndInRosPackagePath) {
  const std::string mesh = write("ws/some_pkg/meshes/a.stl", kStl);
  write("ws/some_pkg/package.xml", "<package/>");
  const std::string package = path("ws/some_pkg"), uri = "package://some_pkg/meshes/a.stl";
  EXPECT_EQ(PackagePaths({{"some_pkg", package}}).resolve(uri), mesh);
  EXPECT_THROW(PackagePaths().resolve(uri), ModelError);
  const char* before = std::getenv("ROS_PACKAGE_PATH");
  const std::string saved = before ? before : "";
  for (const std::string& entry : {package, path("ws")}) {
    setenv("ROS_PACKAGE_PATH", ("/nowhere:" + entry).c_str(), 1);
    EXPECT_EQ(PackagePaths().resolve(uri), mesh);
  }
  before ? setenv("ROS_PACKAGE_PATH", saved.c_str(), 1) : unsetenv("ROS_PACKAGE_PATH");
  EXPECT_EQ(PackagePaths().resolve("meshes/a.stl", package), mesh);
  EXPECT_EQ(PackagePaths().resolve("file://" + mesh), mesh);
  EXPECT_THROW(PackagePaths({{"some_pkg", package}}).resolve("package://some_pkg/b.stl"), ModelError);
}

TEST_F(SceneFiles, SceneIsReadWithTargetsAndSolids) {
  write("t.yaml",
        "{name: blob, color_rgb: [20, 21, 22], outlines_m: [[[0, 0], [1, 0], [0, 1]]], board: {size_m: [3, 4]}}");
  const Scene scene = loadScene(SceneConfig::fromYaml(YAML::Load(
                                    "{background_rgb: [1, 2, 3], models: [{name: target, file: \"package://p/t.yaml\", "
                                    "position_m: [1, 2, 3], rpy_rad: [0, 0, 1.5707963267948966]}], solids: "
                                    "[{name: a, box_m: [1, 1, 1], color_rgb: [9, 8, 7]}, {name: b, sphere_m: 0.5}]}")),
                                PackagePaths({{"p", folder_.string()}}));
  EXPECT_EQ(scene.background, (Rgb{1, 2, 3}));
  const PlanarModel& target = scene.model("target");
  EXPECT_EQ(target.color(), (Rgb{20, 21, 22}));
  EXPECT_EQ(target.board()->size_m, Eigen::Vector2d(3, 4));
  constexpr double kRounding = 1e-14;
  EXPECT_LT((target.X_WM * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), kRounding);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].shapes[0].color, (Rgb{9, 8, 7}));
  EXPECT_THROW(scene.model("b"), UnknownNameError);
}

TEST_F(SceneFiles, FaultsOfASceneAreListedTogether) {
  const YAML::Node scene =
      YAML::Load("{background_rgb: [1, 2], models: [{name: t, outlines_m: 3, colour: 1}], solids: [{name: s}]}");
  const std::string said = messageOf<ParameterError>([&] { SceneConfig::fromYaml(scene); });
  for (const char* key : {"background_rgb", "outlines_m", "colour", "allowed one of box_m"}) EXPECT_HAS(said, key);
}

TEST(PlanarModel, TrianglesCoverTheOutlineExactlyWhicheverWayItRuns) {
  for (const bool reversed : {false, true}) {
    Polygon outline = lShape();
    if (reversed) std::reverse(outline.begin(), outline.end());
    const PlanarModel model("l", {outline}, Rgb{});
    double area = 0.0;
    for (const auto& [a, b, c] : model.triangles(0)) {
      const Polygon& p = model.outlines()[0];
      const Eigen::Vector2d e1 = p[b] - p[a], e2 = p[c] - p[a];
      const double twice = e1.x() * e2.y() - e1.y() * e2.x();
      EXPECT_GE(twice, 0.0);
      area += 0.5 * twice;
    }
    constexpr double kRounding = 1e-15;
    EXPECT_NEAR(area, 0.13 * 0.03 + 0.04 * 0.07, kRounding);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::scene_test
