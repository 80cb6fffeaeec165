// 500 documents broken at random, each from its case number alone: FuzzCase(k) is the same case on every machine.
#include <tinyxml2.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kCases = 500;

const std::vector<std::string> kValues = {"nan",    "inf",  "-inf", "-1",  "0",     "1e308",   "-1e308",
                                          "1e-320", "abc",  "",     "1 2", "0 0 0", "1 1 1 1", "true",
                                          "world",  "0x7f", "1e99", "-0",  "left",  "b_swing"};

const char kSim[] = R"(
period_s: 0.001
gravity_m_s2: [0, 0, -9.81]
drive: implicit
base: as_urdf
base_pose: {position_m: [0, 0, 1], rpy_rad: [0, 0.1, 0]}
seed: 3
initial_positions: {b_swing: 0.1}
command_timeout_s: 0.1
contacts: {ground_plane: {z_m: 0, friction: 0.5}, pairs: [[robot, crate]], free_bodies: {crate: 0.5}}
cameras:
  - {name: camera, frame: world, width: 24, height: 16, horizontal_fov_rad: 1.2, rate_hz: 30.0, near_m: 0.02, far_m: 5.0,
     distortion_model: plumb_bob, distortion: [-0.1, 0.01, 0, 0, 0], encoding: rgb8, noise_stddev: 0.5, exposure_s: 0.002,
     exposure_samples: 2, drop_probability: 0.1, latency_s: 0.001}
scene:
  background_rgb: [230, 230, 230]
  light_direction: [0, 0, -1]
  models:
    - {name: target, color_rgb: [20, 20, 20], outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05]]],
       board: {size_m: [0.4, 0.3], color_rgb: [255, 255, 255]}, motion: {type: circle, radius_m: 0.1,
       angular_speed_rad_per_s: 1.0, axis: [0, 0, 1], delay_s: 0.001}}
  solids:
    - {name: crate, box_m: [0.1, 0.1, 0.1], position_m: [0.5, 0, 0.1], rpy_rad: [0, 0, 0]}
    - {name: ball, sphere_m: 0.1, mass_kg: 0.5, touches: [crate], position_m: [0.5, 0, 0.4]}
)";

const char kControllers[] = R"(
swing: {type: effort_controllers/JointPositionController, joint: b_swing, pid: {p: 100, i: 1, d: 2, i_clamp: 5}}
slide: {type: position_controllers/JointPositionController, joint: a_slide}
joint_state: {type: joint_state_controller/JointStateController, publish_rate: 50}
joint_limits: {b_swing: {has_velocity_limits: true, max_velocity: 2.0, has_acceleration_limits: true, max_acceleration: 5},
  a_slide: {has_position_limits: true, min_position: -1, max_position: 1, has_soft_limits: true, k_position: 10,
            k_velocity: 5, soft_lower_limit: -0.9, soft_upper_limit: 0.9}}
)";

class Breaker {
 public:
  explicit Breaker(int fuzz_case) : random_(static_cast<std::uint32_t>(fuzz_case)) {}

  int below(std::size_t n) { return static_cast<int>(random_() % n); }
  const std::string& value() { return kValues[below(kValues.size())]; }

  std::string breakXml(const std::string& text) {
    tinyxml2::XMLDocument document;
    document.Parse(text.c_str());
    for (int count = 1 + below(3); count > 0; --count) breakElement(document);
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    std::string broken = printer.CStr();
    switch (below(25)) {
      case 0:
        return broken.substr(0, below(broken.size()));
      case 1:
        return broken.insert(below(broken.size()), "<");
      case 2:
        broken[below(broken.size())] = static_cast<char>(below(256));
        return broken;
      case 3: {
        std::string deep;
        for (int k = 0; k < 5000; ++k) deep += "<link name=\"a\">";
        return broken.insert(broken.find("<link"), deep);
      }
      default:
        return broken;
    }
  }

  void breakYaml(YAML::Node node, int depth = 0) {
    if (!(node.IsMap() || node.IsSequence()) || node.size() == 0) return;
    auto chosen = node.begin();
    std::advance(chosen, below(node.size()));
    YAML::Node child = node.IsMap() ? YAML::Node(chosen->second) : YAML::Node(*chosen);
    if (depth < 4 && child.size() > 0 && below(3) > 0) return breakYaml(child, depth + 1);
    switch (below(node.IsMap() ? 5 : 3)) {
      case 0:
        child = YAML::Load(value().empty() ? "~" : value() == "inf" ? ".inf" : value() == "nan" ? ".nan" : value());
        break;
      case 1:
        child = YAML::Load("[1, {a: b}, ~]");
        break;
      case 2:
        child = YAML::Load("{x: 1, type: 7}");
        break;
      case 3:
        node.remove(chosen->first.as<std::string>());
        break;
      default:
        node[value() + "_"] = YAML::Clone(child);
    }
  }

 private:
  static void collect(tinyxml2::XMLElement* element, std::vector<tinyxml2::XMLElement*>& all) {
    for (auto* child = element->FirstChildElement(); child; child = child->NextSiblingElement()) {
      all.push_back(child);
      collect(child, all);
    }
  }

  void breakElement(tinyxml2::XMLDocument& document) {
    if (!document.RootElement()) return;
    std::vector<tinyxml2::XMLElement*> all;
    collect(document.RootElement(), all);
    if (all.empty()) return;
    tinyxml2::XMLElement* element = all[below(all.size())];
    tinyxml2::XMLElement* other = all[below(all.size())];
    switch (below(8)) {
      case 0:
        return document.DeleteNode(element);
      case 1:
        element->Parent()->InsertAfterChild(element, element->DeepClone(&document));
        return;
      case 2:
        return element->SetName(other->Name());
      case 3:
        other->InsertEndChild(element->DeepClone(&document));
        return;
      case 4:
        return element->SetText(value().c_str());
      default:
        return breakAttribute(*element, *other);
    }
  }

  void breakAttribute(tinyxml2::XMLElement& element, const tinyxml2::XMLElement& other) {
    const tinyxml2::XMLAttribute* attribute = element.FirstAttribute();
    if (!attribute) return element.SetAttribute("name", value().c_str());
    for (int skip = below(4); skip > 0 && attribute->Next(); --skip) attribute = attribute->Next();
    const std::string name = attribute->Name();
    switch (below(4)) {
      case 0:
        return element.DeleteAttribute(name.c_str());
      case 1:  // what another element has: cycles, followers of strangers, names used twice
        return element.SetAttribute(name.c_str(), other.FirstAttribute() ? other.FirstAttribute()->Value() : "");
      default:
        return element.SetAttribute(name.c_str(), value().c_str());
    }
  }

  std::mt19937 random_;
};

/** What happens to case k: "" if it runs, else the refusal. */
std::string outcome(int fuzz_case) {
  Breaker breaker(fuzz_case);
  const char* kFiles[] = {"two_link_full.urdf", "mimic_gripper.urdf", "two_link_full.urdf", "sphere.urdf"};
  std::string urdf = readUrdf(kFiles[fuzz_case % 4]);
  YAML::Node sim = YAML::Load(kSim);
  YAML::Node controllers = YAML::Load(kControllers);
  if (fuzz_case % 4 != 0 && fuzz_case % 4 != 2) {
    controllers = YAML::Node(YAML::NodeType::Map);
    sim.remove("initial_positions");
    sim["cameras"][0]["frame"] = fuzz_case % 4 == 3 ? "ball" : "hand";
    if (fuzz_case % 4 == 3) sim["base"] = "floating";
  }
  const int kind = breaker.below(4);
  if (fuzz_case % 8 == 2) sim.remove("cameras");  // those of the <gazebo> tags instead
  if (kind < 2) urdf = breaker.breakXml(urdf);
  if (kind == 2) breaker.breakYaml(sim);
  if (kind == 3) breaker.breakYaml(controllers.size() > 0 ? controllers : sim);
  try {
    // The mesh of the file belongs to nobody.
    const auto mesh = urdf.find("<mesh");
    if (mesh != std::string::npos) urdf.replace(mesh, 5, "<sphere radius=\"0.02\"");
    Simulation simulation(loadRobotModel(urdf, "fuzz.urdf"), SimulationConfig::fromYaml(sim), controllers);
    simulation.step(5);
    if (!simulation.cameras().names().empty()) simulation.render(0);
    simulation.restoreState(simulation.saveState());
  } catch (const ArasError& error) {
    return *error.what() ? error.what() : "no word";
  }
  return "";
}

/** The first of these words in a text, or npos. */
std::size_t firstOf(const std::string& text, const std::vector<const char*>& words) {
  std::size_t first = std::string::npos;
  for (const char* word : words) first = std::min(first, text.find(word));
  return first;
}

/** Whether a line of a refusal says of what, what was found, and what is allowed, in this order. */
bool namesItsCause(const std::string& line) {
  const std::size_t found = firstOf(line, {"found ", " is ", " has ", ": mimics ", " acts on ", "' does not exist"});
  const std::size_t allowed = line.find_first_of(",;(", found);
  return found != std::string::npos && found >= 3 && allowed != std::string::npos &&
         firstOf(line.substr(allowed), {"allowed", "must ", "models: "}) != std::string::npos;
}

TEST(Fuzz, BrokenDocumentsRunOrAreRefusedByName) {
  int refused = 0;
  for (int fuzz_case = 0; fuzz_case < kCases; ++fuzz_case) {
    SCOPED_TRACE("case " + std::to_string(fuzz_case));
    std::string text;
    EXPECT_NO_THROW(text = outcome(fuzz_case));
    refused += !text.empty();
    if (text.empty()) continue;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty() && line.back() == ':') continue;  // of what the lines after it are
      EXPECT_TRUE(namesItsCause(line)) << line;
    }
  }
  // Broken enough to be refused, whole enough that the refusals are not all of the first line.
  EXPECT_GT(refused, kCases / 4);
  EXPECT_LT(refused, kCases);
}

}  // namespace
}  // namespace aras_visual_servo_sim
