#pragma once

#include <array>

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

/** The image whose gradient the interaction matrix uses: the reference, the current one, or the mean of both. */
enum class GradientOf { kDesired, kCurrent, kMean };

/** What may differ between two images of the same view: nothing, an offset of the grey levels, or gain and offset. */
enum class Illumination { kConstant, kOffset, kGainAndOffset };

/** What is compared: the grey levels themselves, or features that are made of all of them. */
enum class Mapping { kNone, kPca, kDct, kMixture, kMutualInformation };

/** The sections of the mappings, as their schemas (schema/pca.yaml and so on) describe them. */
struct PcaConfig {
  int components{};
  int views{};
  double spread{};
  int seed{};
};
struct DctConfig {
  int coefficients{};
};
struct MixtureConfig {
  double extension_px{};
  double final_extension_px{};
};
struct MutualInformationConfig {
  int bins{};
};

/** The section `vision.photometric` of a scenario. What each key means, its range and its default stand in
 *  schema/photometric.yaml, by the names of these members; one made by readPhotometricConfig() has them all. */
struct PhotometricConfig {
  GradientOf interaction{};
  Illumination illumination{};
  int levels{};
  double switch_px{};
  double smoothing_px{};
  int border_px{};
  double min_contrast{};
  std::array<double, 3> target_normal_C{};
  Mapping mapping{};
  PcaConfig pca{};
  DctConfig dct{};
  MixtureConfig mixture{};
  MutualInformationConfig mutual_information{};
};

/** @param node  a map as schema/photometric.yaml describes it
 *  @throws ParameterError listing every unknown, mistyped or out-of-range key */
PhotometricConfig readPhotometricConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
