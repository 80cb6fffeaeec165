// Materials of mesh files, against the same material of a shape.
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "light_tools.hpp"
#include "tools/folder_fixture.hpp"

namespace aras_visual_servo_sim::testing::opengl_mesh_material_test {
namespace {

/** Of a grey square of 1 m in z = 0. */
const char kObj[] =
    "mtllib plate.mtl\nv -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nvn 0 0 1\nusemtl m\n"
    "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n";

class OpenGlMeshMaterial : public FolderFixture {
 protected:
  /** Name of a file. @param keys  of the material, besides its diffuse colour */
  std::string obj(const std::string& keys) const {
    write("plate.mtl", "newmtl m\nKd 0.5 0.5 0.5\n" + keys + "\n");
    return write("plate.obj", kObj);
  }
  /** @param effect  what stands in <technique>  @param extra  after it */
  std::string collada(const std::string& effect, const std::string& extra = "") const {
    return write("plate.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="common">)" +
                                  effect + "</technique>" + extra + R"(</profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">-0.5 -0.5 0 0.5 -0.5 0
0.5 0.5 0 -0.5 0.5 0</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X"
type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="2" material="s">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>)");
  }
};

const char kGrey[] = "<diffuse><color>0.5 0.5 0.5 1</color></diffuse>";

/** The body of a solid of this mesh file. @param keys  others of the solid */
Body bodyOf(const std::string& mesh, const std::string& keys = "") {
  const std::string text = "{solids: [{name: plate, color_rgb: [255, 0, 0], mesh: '" + mesh + "'" + keys + "}]}";
  return loadScene(SceneConfig::fromYaml(YAML::Load(text)), PackagePaths()).bodies[0];
}

/** The plate over a floor, under a sun with highlights and shadows. */
Scene sceneOf(const Body& plate, double height_m = 0.3) {
  Light sun = lamp(Light::Type::kDirectional, 0.4);
  sun.specular.setConstant(0.5);
  sun.direction_W = {0.3, 0.0, -1.0};
  Scene scene = floorUnder({sun});
  scene.bodies.push_back(plate);
  scene.bodies.back().X_WB.p.z() = height_m;
  return scene;
}

/** The mesh of a file as if it said nothing of its material. */
Body plainOf(const std::string& mesh, const Material& material = Material{}) {
  Body body = solid("plate", loadMesh(mesh), {255, 0, 0}, {0.0, 0.0, 0.0});
  body.shapes[0].material = material;
  return body;
}

Image seen(const Scene& scene, const Pose& X_WC = lookingDown({0.1, 0.0, 1.3})) {
  return renderOpenGl(CameraModel(rgbConfig()), X_WC, scene);
}

/** Holds that a file's material and that of a shape look the same, and not as none at all. */
void expectSame(const std::string& mesh, const Material& material) {
  const Image image = seen(sceneOf(bodyOf(mesh)));
  EXPECT_EQ(image.data, seen(sceneOf(plainOf(mesh, material))).data);
  EXPECT_NE(image.data, seen(sceneOf(plainOf(mesh))).data);
}

TEST_F(OpenGlMeshMaterial, OfObjAreHighlightsOwnLightAndOpacity) {
  Material material;
  material.specular = {0.75, 0.5, 0.25};
  material.shininess = 30.0;
  expectSame(obj("Ks 0.75 0.5 0.25\nNs 30\nillum 2"), material);
  material = Material{};
  material.emissive.setConstant(0.25);
  expectSame(obj("Ke 0.25 0.25 0.25"), material);
  material = Material{};
  material.opacity = 0.25;
  expectSame(obj("d 0.25"), material);
  expectSame(obj("Tr 0.75"), material);
}

TEST_F(OpenGlMeshMaterial, OfColladaAreHighlightsOwnLightOpacityAndBacks) {
  Material material;
  material.specular = {0.75, 0.5, 0.25};
  material.shininess = 30.0;
  const std::string glossy =
      "<specular><color>0.75 0.5 0.25 1</color></specular><shininess><float>30</float></shininess>";
  expectSame(collada("<phong>" + (kGrey + glossy) + "</phong>"), material);
  expectSame(collada("<blinn>" + (kGrey + glossy) + "</blinn>"), material);
  material = Material{};
  material.emissive.setConstant(0.25);
  expectSame(
      collada("<lambert><emission><color>0.25 0.25 0.25 1</color></emission>" + std::string(kGrey) + "</lambert>"),
      material);
  material = Material{};
  material.opacity = 0.25;
  expectSame(collada("<lambert>" + std::string(kGrey) + "<transparent opaque=\"A_ONE\"><color>1 1 1 1</color>" +
                     "</transparent><transparency><float>0.25</float></transparency></lambert>"),
             material);
  const std::string two_sided = collada("<lambert>" + std::string(kGrey) + "</lambert>",
                                        "<extra><technique profile=\"GOOGLEEARTH\"><double_sided>1</double_sided>"
                                        "</technique></extra>");
  const Pose below{{0.0, 0.0, 0.05}, Eigen::Quaterniond::Identity()};
  EXPECT_NE(seen(sceneOf(bodyOf(two_sided)), below).pixel(160, 120)[0], 0);
  EXPECT_EQ(seen(sceneOf(plainOf(two_sided)), below).pixel(160, 120)[0], 0);
}

TEST_F(OpenGlMeshMaterial, OfAPictureThatGivesTheMostLightIsThePicture) {
  const std::vector<std::uint8_t> rgb{100, 200, 50};
  stbi_write_png(path("c.png").c_str(), 1, 1, 3, rgb.data(), 3);
  const std::string plate = write("pictured.obj",
                                  "mtllib pictured.mtl\nv -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\n"
                                  "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\n"
                                  "f 1/1/1 3/3/1 4/4/1\n");
  const auto made = [&](const std::string& keys) {
    write("pictured.mtl", "newmtl m\nKd 1 1 1\n" + keys + "\n");
    return bodyOf(plate);
  };
  const Body glowing = made("Ke 1 1 1\nmap_Kd c.png");
  Scene scene = sceneOf(glowing);
  for (const double ambient : {0.0, 0.5}) {
    scene.lighting.ambient.setConstant(ambient);
    const Image image = seen(scene);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(image.pixel(160, 120)[c], rgb[c]) << ambient;
    scene.lighting.lights.clear();
  }
  EXPECT_EQ(made("Ke 1 1 0.5\nmap_Kd c.png").shapes[0].material.emissive, Eigen::Vector3d(1.0, 1.0, 0.5));
  EXPECT_FALSE(made("Ke 1 1 0.5\nmap_Kd c.png").shapes[0].material.unlit);
  EXPECT_EQ(made("Ke 1 1 1").shapes[0].material.emissive, Eigen::Vector3d::Ones());
}

TEST_F(OpenGlMeshMaterial, OfAThingThatNobodyCouldSeeIsOpaque) {
  const Body body =
      bodyOf(collada("<lambert>" + std::string(kGrey) + "<transparent><color>1 1 1 1</color></transparent>" +
                     "<transparency><float>0</float></transparency></lambert>"));
  EXPECT_EQ(body.shapes[0].material.opacity, 1.0);
}

TEST_F(OpenGlMeshMaterial, OfALambertIsWithoutHighlights) {
  EXPECT_TRUE(bodyOf(collada("<lambert>" + std::string(kGrey) + "</lambert>")).shapes[0].material.specular.isZero());
}

TEST_F(OpenGlMeshMaterial, OfPartsEachHasItsOwnAndOpaqueOnesCastShadows) {
  write("plate.mtl", "newmtl glass\nKd 0 0 1\nd 0.25\nnewmtl wood\nKd 0.5 0.3 0.1\n");
  const std::string left = "v -0.2 -0.2 0\nv 0 -0.2 0\nv 0 0.2 0\nv -0.2 0.2 0\n";
  const std::string right = "v 0 -0.2 0\nv 0.2 -0.2 0\nv 0.2 0.2 0\nv 0 0.2 0\n";
  const Body body = bodyOf(write("plate.obj", "mtllib plate.mtl\n" + left + right +
                                                  "vn 0 0 1\nusemtl glass\n"
                                                  "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\nusemtl wood\n"
                                                  "f 5//1 6//1 7//1\nf 5//1 7//1 8//1\n"));
  EXPECT_EQ(body.shapes.size(), 2u);
  Scene scene = sceneOf(body, 0.1);
  scene.lighting.lights[0].direction_W = {0.0, 0.0, -1.0};
  const CameraModel camera(rgbConfig());
  const auto at = [&](const Pose& X_WC, const Eigen::Vector3d& p) {
    const Eigen::Vector2d px = *camera.project(X_WC.inverse() * p);
    const Image image = seen(scene, X_WC);
    const std::uint8_t* pixel = image.pixel(int(std::lround(px.x())), int(std::lround(px.y())));
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  // White is 0.5 in this light; a quarter of the blue glass lies over it.
  const auto glass = at(kAbove, {-0.1, 0.0, 0.1}), wood = at(kAbove, {0.1, 0.0, 0.1});
  EXPECT_NEAR(glass[0], 0.75 * 127.5, kRounding);
  EXPECT_NEAR(glass[2], 127.5, kRounding);
  EXPECT_NEAR(wood[0], 0.5 * 127.5, kRounding);
  EXPECT_NEAR(wood[2], 0.1 * 127.5, kRounding);
  // From aside, the floor below them is seen: only the wood takes the sun from it.
  const Pose aside{{0.0, -1.2, 0.05},
                   Eigen::Quaterniond(Eigen::AngleAxisd(-0.5 * M_PI - 0.04, Eigen::Vector3d::UnitX()))};
  EXPECT_NEAR(at(aside, {-0.1, 0.0, 0.0})[0], 127.5, kRounding);
  EXPECT_NEAR(at(aside, {0.1, 0.0, 0.0})[0], 25.5, kRounding);
}

TEST_F(OpenGlMeshMaterial, TheSceneOrTheUrdfCountsBeforeTheFile) {
  const std::string file = obj("Ks 0.75 0.5 0.25\nNs 30\nd 0.5");
  const auto opacityOf = [&](const std::string& keys) { return bodyOf(file, keys).shapes[0].material.opacity; };
  EXPECT_EQ(opacityOf(""), 0.5);
  EXPECT_EQ(opacityOf(", material: {casts_shadows: false, ambient_share: 0.7}"), 0.5);
  EXPECT_EQ(opacityOf(", material: {opacity: 0.9}"), 0.9);
  const auto linkOf = [&](const std::string& material, const std::string& gazebo = "") {
    Scene scene;
    addRobotBodies(loadRobotModel("<robot name='r'><link name='l'><visual><geometry><mesh filename='" + file +
                                      "'/></geometry>" + material + "</visual></link>" + gazebo + "</robot>",
                                  "r"),
                   PackagePaths(), scene);
    return scene.bodies[0].shapes[0].material;
  };
  EXPECT_EQ(linkOf("").opacity, 0.5);
  EXPECT_FALSE(linkOf("").unlit);
  EXPECT_EQ(linkOf("<material name='m'><color rgba='1 0 0 1'/></material>").opacity, 1.0);
  const Material dark = linkOf("",
                               "<gazebo reference='l'><visual><material><lighting>false</lighting></material>"
                               "</visual></gazebo>");
  EXPECT_TRUE(dark.unlit);
  EXPECT_EQ(dark.opacity, 0.5);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_mesh_material_test
