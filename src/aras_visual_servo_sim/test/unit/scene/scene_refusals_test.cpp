// What is said of a scene, a model or a mesh that cannot be: which thing, what was found, what is allowed.
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/folder_fixture.hpp"
#include "tools/messages.hpp"

namespace aras_visual_servo_sim::scene_refusals_test {
namespace {

struct Refusal {
  const char* yaml;
  const char* said;
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.yaml; }

class EachScene : public ::testing::TestWithParam<Refusal> {};

TEST_P(EachScene, ThatCannotBeIsRefusedByName) {
  const auto read = [] { SceneConfig::fromYaml(YAML::Load(GetParam().yaml)); };
  EXPECT_HAS(messageOf<ParameterError>(read), GetParam().said);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, EachScene,
    ::testing::Values(
        Refusal{"{light_direction: [0, 0, 0]}", "scene.light_direction: found zero"},
        Refusal{"{models: [{name: m, file: m.yaml, attached_to: l, motion: {type: constant_velocity}}]}",
                "motion: found it together with attached_to"},
        Refusal{"{models: [{name: m, file: m.yaml, board: {size_m: [1, 1]}}]}",
                "scene.models[0].board: found it together with file"},
        Refusal{"{models: [{name: m, file: a.yaml}, {name: m, file: b.yaml}]}", "scene.models: found two named 'm'"},
        Refusal{"{solids: [{name: s, urdf: s.urdf, mass_kg: 1}]}",
                "scene.solids[0].mass_kg: found it together with urdf"},
        Refusal{"{solids: [{name: s, sphere_m: 1, scale: [1, 1, 1]}]}", "scene.solids[0].scale: found it without mesh"},
        Refusal{"{solids: [{name: s, sphere_m: 1}], models: [{name: s, file: s.yaml}]}",
                "scene.solids: found a solid and a model named 's'"},
        Refusal{"{lighting: {lights: [{name: a, type: spot, direction: [0, 0, -1], inner_angle_rad: 0.5, "
                "outer_angle_rad: 0.4}]}}",
                "outer_angle_rad: found 0.4 of light 'a', allowed more than inner_angle_rad, 0.5"},
        Refusal{"{lighting: {lights: [{name: a, type: spot}]}}", "direction: found none of light 'a'"},
        Refusal{"{lighting: {lights: [{name: a, type: directional, direction: [0, 0, 0]}]}}",
                "direction: found zero of light 'a'"},
        Refusal{"{solids: [{name: s, sphere_m: 1, motion: {type: waypoints, waypoints: [{time_s: 2, position_m: [0, "
                "0, 0]}, {time_s: 1, position_m: [0, 0, 0]}]}}]}",
                "waypoints[1].time_s: found 1, allowed > 2"}));

TEST(Scene, AnUnknownModelOrBodyIsToldWhichThereAre) {
  Scene scene;
  EXPECT_EQ(messageOf<UnknownNameError>([&] { scene.model("m"); }), "model 'm' does not exist; models: none");
  EXPECT_EQ(messageOf<UnknownNameError>([&] { scene.body("b"); }), "body 'b' does not exist; bodies: none");
  scene.bodies.resize(2);
  scene.bodies[0].name = "box";
  scene.bodies[1].name = "ball";
  EXPECT_EQ(messageOf<UnknownNameError>([&] { scene.body("b"); }), "body 'b' does not exist; bodies: box, ball");
}

TEST(PlanarModel, SaysWhatIsWrongWithItsOutlines) {
  const auto fault = [](const std::vector<Polygon>& outlines) {
    return messageOf<ModelError>([&] { PlanarModel("m", outlines, Rgb{}); });
  };
  EXPECT_HAS(fault({}), "model 'm': found no outlines");
  EXPECT_HAS(fault({{{0, 0}, {1, 0}}}), "model 'm': outline 0: found 2 corners, allowed 3");
  EXPECT_EQ(fault({{{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {std::nan(""), 0}, {1, 1}}}),
            "model 'm': outline 1: a corner is not finite");
  EXPECT_HAS(messageOf<ModelError>([] { PlanarModel("m", {}, Rgb{}, PlanarModel::Board{{1, 0}, {}}); }), "board");
  EXPECT_HAS(fault({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}), "model 'm': outline 0: edges cross");
  EXPECT_EQ(fault({{{0, 0}, {1, 1}, {2, 2}}}), "model 'm': outline 0: covers no area");
}

TEST(PlanarModel, OutlinesMayTouchNowhere) {
  const auto make = [](const Polygon& outline) { return [outline] { PlanarModel("m", {outline}, Rgb{}); }; };
  const char* const said = "edges cross or touch";
  // A corner on an edge, once for each of the two ends of either edge.
  EXPECT_HAS(messageOf<ModelError>(make({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}})), said);
  EXPECT_HAS(messageOf<ModelError>(make({{4, 0}, {4, 4}, {2, 0}, {0, 4}, {0, 0}})), said);
  EXPECT_HAS(messageOf<ModelError>(make({{2, 0}, {0, 4}, {0, 0}, {4, 0}, {4, 4}})), said);
  EXPECT_NO_THROW(make({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}})());
}

TEST(PlanarModel, CornersOnAStraightEdgeAreCoveredToo) {
  const PlanarModel model("m", {{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}}, Rgb{});
  const Polygon& p = model.outlines()[0];
  double area = 0.0;
  for (const auto& [a, b, c] : model.triangles(0)) {
    const Eigen::Vector2d e1 = p[b] - p[a], e2 = p[c] - p[a];
    area += 0.5 * (e1.x() * e2.y() - e1.y() * e2.x());
  }
  EXPECT_EQ(area, 4.0);
}

TEST(ModelEntry, ThatIsNeitherAFileNorAMapIsRefused) {
  EXPECT_EQ(messageOf<ParameterError>([] { modelEntry("m", "a: 1\n- b"); }).substr(0, 11), "model 'm': ");
  EXPECT_EQ(messageOf<ParameterError>([] { modelEntry("m", "[1]\n[2]"); }).substr(0, 11), "model 'm': ");
  EXPECT_HAS(messageOf<ParameterError>([] { modelEntry("m", "- 1\n- 2"); }), "model 'm': found '- 1\n- 2'");
}

TEST(SolidOfAUrdf, SaysWhatItLacksOrHasTooMuch) {
  const auto fault = [](const std::string& inside) {
    const std::string urdf = "<robot name='r'><link name='a'/>" + inside + "</robot>";
    return messageOf<ModelError>([&] { bodyFromUrdf("m", urdf, PackagePaths()); });
  };
  EXPECT_HAS(fault(""), "model 'm': no link of its URDF");
  EXPECT_HAS(fault("<link name='b'/><joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>"),
             "model 'm': joint 'j'");
}

class MeshRefusals : public testing::FolderFixture {
 protected:
  std::string fault(const std::string& mesh, const Eigen::Vector3d& scale = Eigen::Vector3d::Ones()) const {
    return messageOf<ModelError>([&] { loadMesh(mesh, scale); });
  }
};

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(MeshRefusals, AScaleIsFiniteAndNotZero) {
  const std::string mesh = write("a.obj", kTriangle + std::string("f 1 2 3\n"));
  EXPECT_EQ(fault(mesh, {1, 0, 1}), "mesh '" + mesh + "': scale must be finite and not zero");
  EXPECT_EQ(fault(mesh, {1, std::nan(""), 1}), "mesh '" + mesh + "': scale must be finite and not zero");
}

TEST_F(MeshRefusals, APictureIsLookedForWhereFilesHaveTheirs) {
  write("a.mtl", "newmtl m\nmap_Kd lost.png\n");
  const std::string mesh =
      write("a.obj", "mtllib a.mtl\n" + std::string(kTriangle) + "vt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n");
  const std::string said = fault(mesh);
  EXPECT_HAS(said, "mesh '" + mesh + "': picture 'lost.png' not found, looked for " + path("lost.png"));
  EXPECT_HAS(said, "materials/textures/lost.png");
}

TEST_F(MeshRefusals, APictureNeedsTextureCoordinates) {
  write("a.mtl", "newmtl m\nmap_Kd a.png\n");
  const std::string mesh = write("a.obj", "mtllib a.mtl\n" + std::string(kTriangle) + "usemtl m\nf 1 2 3\n");
  EXPECT_HAS(fault(mesh), "has the picture 'a.png' but no texture coordinates of set 0");
}

TEST_F(MeshRefusals, APointIsFinite) {
  const std::string mesh = write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1e999\nf 1 2 3\n");
  EXPECT_EQ(fault(mesh), "mesh '" + mesh + "': a point is not finite");
}

TEST_F(MeshRefusals, AModelFileIsReadableYaml) {
  const std::string file = write("m.yaml", "{name: [");
  EXPECT_EQ(messageOf<ModelError>([&] { loadPlanarModel(file); }).find("file '" + file + "': "), 0u);
}

TEST(LightText, ThatIsEmptyOrNoLightIsRefused) {
  EXPECT_EQ(messageOf<ParameterError>([] { lightFromText(" \n"); }), "light: found an empty text, allowed SDF or YAML");
  EXPECT_EQ(messageOf<ParameterError>([] { lightFromText("{name: ["); }).find("light: "), 0u);
}

}  // namespace
}  // namespace aras_visual_servo_sim::scene_refusals_test
