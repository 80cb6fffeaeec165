// What a camera node is sent: camera_info and images, into the extractors of moments, points and luminance.
#include <fuzzer/FuzzedDataProvider.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "target.hpp"

using namespace aras_visual_servo_camera;

namespace {

constexpr int kMostSide = 40;  // pixels: larger images take longer and show the same

double number(FuzzedDataProvider& bytes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static const double kNumbers[] = {0.0,   1.0,   -1.0,   20.0,   -20.0,     19.5,       0.1,          -0.33,
                                    1e-9,  -1e-9, 1e9,    -1e9,   1e18,      -1e18,      1e300,        -1e300,
                                    1e308, 1e-30, 5e-324, 1e-308, kInfinity, -kInfinity, std::nan(""), 1e4};
  if (bytes.ConsumeBool()) return bytes.PickValueInArray(kNumbers);
  double value = 0.0;
  const std::string raw = bytes.ConsumeBytesAsString(sizeof(value));
  std::memcpy(&value, raw.data(), raw.size());
  return value;
}

/** A usual camera, some of whose numbers are others. */
CameraIntrinsics intrinsics(FuzzedDataProvider& bytes) {
  const int width = bytes.ConsumeIntegralInRange(-1, kMostSide), height = bytes.ConsumeIntegralInRange(-1, kMostSide);
  std::array<double, 9> K{20.0, 0.0, 10.0, 0.0, 20.0, 10.0, 0.0, 0.0, 1.0};
  for (int k = bytes.ConsumeIntegralInRange(0, 3); k > 0; --k) {
    K[bytes.ConsumeIntegralInRange<std::size_t>(0, 8)] = number(bytes);
  }
  std::vector<double> D(bytes.ConsumeIntegralInRange<std::size_t>(0, 8));
  for (double& each : D) each = number(bytes);
  const auto lens =
      bytes.PickValueInArray<std::string>({"", "none", "plumb_bob", "rational_polynomial", "equidistant", "other"});
  return CameraIntrinsics(width, height, K, lens, D);
}

VisionConfig vision(FuzzedDataProvider& bytes) {
  static const char* kTexts[] = {
      "{object: dark, segmentation: coverage, min_area_px: 1}",
      "{object: bright, segmentation: otsu, min_area_px: 1, kernel: {p: 2.5, q: 0.5}}",
      "{object: dark, segmentation: adaptive, adaptive_block_px: 5, min_area_px: 1, order: 8}",
      "{object: dark, segmentation: fixed, threshold: 100, min_area_px: 1, points: corners, point_count: 4}",
      "{object: dark, segmentation: coverage, min_area_px: 1, points: corners, point_count: 3}",
      "{object: dark, segmentation: fixed, threshold: 100, min_area_px: 1, points: blobs, point_count: 2}",
      "{object: dark, segmentation: coverage, min_area_px: 2, component: most_similar, border_margin_px: 2}",
      "{object: dark, segmentation: fixed, threshold: 9, component: nearest_to_previous, switch_images: 1}"};
  static const std::vector<VisionConfig> kConfigs = [] {
    std::vector<VisionConfig> configs;
    for (const char* text : kTexts) configs.push_back(readVisionConfig(YAML::Load(text)));
    return configs;
  }();
  return kConfigs[bytes.ConsumeIntegralInRange<std::size_t>(0, kConfigs.size() - 1)];
}

/** Pixels from the bytes, row by row; when there are no more, a grey field with a dark rectangle. */
class Picture {
 public:
  Picture(const CameraIntrinsics& camera, FuzzedDataProvider& bytes) {
    static const PixelFormat kFormats[] = {PixelFormat::kMono8, PixelFormat::kRgb8, PixelFormat::kBgr8,
                                           PixelFormat::kRgba8};
    view_.format = bytes.PickValueInArray(kFormats);
    view_.width_px = camera.width();
    view_.height_px = camera.height();
    view_.step_bytes = std::size_t(channels(view_.format)) * camera.width() + bytes.ConsumeIntegralInRange(0, 3);
    const int left = bytes.ConsumeIntegralInRange(0, kMostSide), top = bytes.ConsumeIntegralInRange(0, kMostSide);
    const int right = left + bytes.ConsumeIntegralInRange(0, 16), bottom = top + bytes.ConsumeIntegralInRange(0, 16);
    const auto grey = bytes.ConsumeIntegral<std::uint8_t>();
    data_.assign(view_.step_bytes * view_.height_px, 200);
    for (int v = top; v < bottom && v < view_.height_px; ++v) {
      for (int u = left; u < right && u < view_.width_px; ++u) {
        std::memset(&data_[v * view_.step_bytes + std::size_t(u) * channels(view_.format)], grey,
                    static_cast<std::size_t>(channels(view_.format)));
      }
    }
    for (int k = bytes.ConsumeIntegralInRange(0, 64); k > 0 && !data_.empty(); --k) {
      const auto at = bytes.ConsumeIntegralInRange<std::size_t>(0, data_.size() - 1);
      data_[at] = bytes.ConsumeIntegral<std::uint8_t>();
    }
    view_.data = data_.data();
  }
  const ImageView& view() const { return view_; }

 private:
  std::vector<std::uint8_t> data_;
  ImageView view_;
};

void checked(const MomentFeatures& features) {
  if (features.valid && !(std::isfinite(features.area) && std::isfinite(features.xg) && std::isfinite(features.yg))) {
    __builtin_trap();
  }
}

void moments(const CameraIntrinsics& camera, FuzzedDataProvider& bytes) {
  MomentExtractor extractor(camera, vision(bytes));
  for (std::int64_t stamp_ns = 1; stamp_ns < 4; ++stamp_ns) {
    const Picture picture(camera, bytes);
    checked(extractor.process(picture.view(), stamp_ns));
    if (bytes.ConsumeBool()) fuzz::allow([&] { extractor.teach(stamp_ns, number(bytes)); });
    if (bytes.ConsumeBool()) fuzz::allow([&] { extractor.setReference(number(bytes), number(bytes), number(bytes)); });
    if (bytes.remaining_bytes() == 0) return;
  }
}

void luminance(const CameraIntrinsics& camera, FuzzedDataProvider& bytes) {
  static const PhotometricConfig kConfigs[] = {
      readPhotometricConfig(YAML::Load("{border_px: 4, min_contrast: 0}")),
      readPhotometricConfig(YAML::Load("{levels: 2, border_px: 0, smoothing_px: 0.5, illumination: gain_and_offset}")),
      readPhotometricConfig(YAML::Load("{border_px: 4, min_contrast: 0, mapping: dct, dct: {coefficients: 9}}")),
      readPhotometricConfig(
          YAML::Load("{border_px: 4, min_contrast: 0, mapping: pca, pca: {components: 8, views: 9}}")),
      readPhotometricConfig(YAML::Load("{border_px: 4, min_contrast: 0, mapping: mixture}")),
      readPhotometricConfig(YAML::Load("{border_px: 4, min_contrast: 0, mapping: mutual_information}"))};
  PhotometricExtractor extractor(camera,
                                 kConfigs[bytes.ConsumeIntegralInRange<std::size_t>(0, std::size(kConfigs) - 1)]);
  const Picture goal(camera, bytes);
  extractor.setReference(goal.view(), Plane{number(bytes), number(bytes), number(bytes)});
  const Picture now(camera, bytes);
  extractor.process(now.view());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider bytes(data, size);
  fuzz::allow([&] {
    const CameraIntrinsics camera = intrinsics(bytes);
    bytes.ConsumeIntegralInRange(0, 3) == 0 ? luminance(camera, bytes) : moments(camera, bytes);
  });
  return 0;
}
