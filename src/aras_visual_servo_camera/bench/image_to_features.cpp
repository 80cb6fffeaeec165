// Image to features at 320 x 240, f = 195 px, target at 0.5 m: rgb8 unless said. One thread.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "coverage_image.hpp"
#include "point_views.hpp"
#include "usual_vision.hpp"

namespace {

using namespace aras_visual_servo_camera;           // NOLINT: a bench, not a header
using namespace aras_visual_servo_camera::testing;  // NOLINT

std::vector<std::uint8_t> toRgb(const GreyImage& grey) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * grey.data.size());
  for (std::uint8_t g : grey.data) rgb.insert(rgb.end(), 3, g);
  return rgb;
}

void run(benchmark::State& state, const VisionConfig& config, double size_m, bool distorted, bool grey_input,
         double noise = 0.0) {
  const CameraIntrinsics camera = testCamera(distorted);
  GreyImage image = coverageImage(project(blob(size_m), {0.02, 0.01, 0.5, 0.4, 0.1, 0.05}), camera);
  std::mt19937 random(1);
  if (noise > 0.0) addNoise(noise, &random, &image);
  const std::vector<std::uint8_t> rgb = toRgb(image);
  ImageView view = image.view();
  if (!grey_input)
    view = {rgb.data(), image.width, image.height, static_cast<std::size_t>(3) * image.width, PixelFormat::kRgb8};
  MomentExtractor extractor(camera, config);
  extractor.setReference(0.5, extractor.process(view));
  for (auto _ : state) benchmark::DoNotOptimize(extractor.process(view).area);
  if (!extractor.features().valid) state.SkipWithError("the target was not found");
}

VisionConfig withSegmentation(SegmentationMethod method) {
  VisionConfig config = testing::usualVision();
  config.segmentation = method;
  return config;
}

VisionConfig withMostSimilar() {
  VisionConfig config = testing::usualVision();
  config.component = ComponentChoice::kMostSimilar;
  return config;
}

VisionConfig withKernel() {
  VisionConfig config = testing::usualVision();
  config.kernel.emplace();
  return config;
}

/** A rectangle: the blob has no corners. */
void corners(benchmark::State& state, bool distorted) {
  const CameraIntrinsics camera = testCamera(distorted);
  const GreyImage image = coverageImage(project(rectangle(0.17, 0.12), {0.02, 0.01, 0.5, 0.4, 0.1, 0.05}), camera);
  const std::vector<std::uint8_t> rgb = toRgb(image);
  const ImageView view{rgb.data(), image.width, image.height, static_cast<std::size_t>(3) * image.width,
                       PixelFormat::kRgb8};
  MomentExtractor extractor(camera, testing::withPoints(PointSource::kCorners, 4));
  for (auto _ : state) benchmark::DoNotOptimize(extractor.process(view).area);
  if (!extractor.features().valid) state.SkipWithError("the corners were not found");
}

VisionConfig withGivenGreys() {
  VisionConfig config = testing::usualVision();
  config.object_grey = kObjectGrey;
  config.background_grey = kBackgroundGrey;
  return config;
}

constexpr double kUsual_m = 0.17, kLarge_m = 0.45;  // about 65 and 175 px wide

void coverageEstimatedGreys(benchmark::State& s) { run(s, testing::usualVision(), kUsual_m, false, false); }
void coverageGivenGreys(benchmark::State& s) { run(s, withGivenGreys(), kUsual_m, false, false); }
void coverageGivenGreysMono(benchmark::State& s) { run(s, withGivenGreys(), kUsual_m, false, true); }
void coverageDistorted(benchmark::State& s) { run(s, testing::usualVision(), kUsual_m, true, false); }
void coverageNoisy(benchmark::State& s) { run(s, testing::usualVision(), kUsual_m, false, false, 5.0); }
void coverageLargeObject(benchmark::State& s) { run(s, testing::usualVision(), kLarge_m, false, false); }
void coverageLargeObjectDistorted(benchmark::State& s) { run(s, testing::usualVision(), kLarge_m, true, false); }
void fourCorners(benchmark::State& s) { corners(s, false); }
void fourCornersDistorted(benchmark::State& s) { corners(s, true); }
void oneBlob(benchmark::State& s) { run(s, testing::withPoints(PointSource::kBlobs, 1), kUsual_m, false, false); }
void mostSimilar(benchmark::State& s) { run(s, withMostSimilar(), kUsual_m, false, false); }
void kernelProjections(benchmark::State& s) { run(s, withKernel(), kUsual_m, false, false); }
void fixed(benchmark::State& s) { run(s, withSegmentation(SegmentationMethod::kFixed), kUsual_m, false, false); }
void otsu(benchmark::State& s) { run(s, withSegmentation(SegmentationMethod::kOtsu), kUsual_m, false, false); }
void adaptive(benchmark::State& s) { run(s, withSegmentation(SegmentationMethod::kAdaptive), kUsual_m, false, false); }

// A textured plane fills the view, moved by a pixel.
void runPhotometric(benchmark::State& state, GradientOf interaction, int levels, bool distorted) {
  PhotometricConfig config = testing::usualPhotometric();
  config.interaction = interaction;
  config.levels = levels;
  PhotometricExtractor extractor(testCamera(distorted), config);
  GreyImage image(320, 240, 0);
  for (double shift_px : {0.0, 1.0}) {
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u)
        image.at(u, v) = static_cast<std::uint8_t>(
            std::lround(128.0 + 50.0 * std::sin(0.21 * (u - shift_px) + 0.05 * v) + 50.0 * std::cos(0.17 * v)));
    if (shift_px == 0.0) extractor.setReference(image.view(), 0.5);
  }
  for (auto _ : state) benchmark::DoNotOptimize(extractor.process(image.view()).cost);
  if (!extractor.features().valid) state.SkipWithError("no valid features");
}

void photometricDesired(benchmark::State& s) { runPhotometric(s, GradientOf::kDesired, 1, false); }
void photometricMean(benchmark::State& s) { runPhotometric(s, GradientOf::kMean, 1, false); }
void photometricMeanDistorted(benchmark::State& s) { runPhotometric(s, GradientOf::kMean, 1, true); }
void photometricMeanFourLevels(benchmark::State& s) { runPhotometric(s, GradientOf::kMean, 4, false); }

// A board of many rectangles fills 640 x 480, moved by some pixels: keypoints of one image, matched to the goal's.
void runMatches(benchmark::State& state, KeypointDetector detector) {
  MatchingConfig config = readMatchingConfig(YAML::Node());
  config.detector = detector;
  constexpr int kWidth = 640, kHeight = 480;
  MatchExtractor extractor(
      CameraIntrinsics(kWidth, kHeight, {502.3, 0, 319.5, 0, 502.3, 239.5, 0, 0, 1}, "plumb_bob", {}), config);
  GreyImage image(kWidth, kHeight, 0);
  for (int shift_px : {0, 7}) {
    std::mt19937 random(1);
    for (int k = 0; k < 1500; ++k) {
      const int u0 = static_cast<int>(random() % kWidth) + shift_px, v0 = static_cast<int>(random() % kHeight);
      const int w = static_cast<int>(random() % 60), h = static_cast<int>(random() % 60);
      const auto grey = static_cast<std::uint8_t>(random() % 256);
      for (int v = v0; v < std::min(v0 + h, kHeight); ++v)
        for (int u = u0; u < std::min(u0 + w, kWidth); ++u) image.at(u, v) = grey;
    }
    if (shift_px == 0) extractor.setReference(image.view(), 0.6);
  }
  for (auto _ : state) benchmark::DoNotOptimize(extractor.process(image.view()).inliers);
  if (!extractor.features().valid) state.SkipWithError("no valid features");
}

void matchesOrb(benchmark::State& s) { runMatches(s, KeypointDetector::kOrb); }
void matchesAkaze(benchmark::State& s) { runMatches(s, KeypointDetector::kAkaze); }
void matchesSift(benchmark::State& s) { runMatches(s, KeypointDetector::kSift); }

BENCHMARK(matchesOrb)->Unit(benchmark::kMillisecond);
BENCHMARK(matchesAkaze)->Unit(benchmark::kMillisecond);
BENCHMARK(matchesSift)->Unit(benchmark::kMillisecond);
BENCHMARK(photometricDesired)->Unit(benchmark::kMicrosecond);
BENCHMARK(photometricMean)->Unit(benchmark::kMicrosecond);
BENCHMARK(photometricMeanDistorted)->Unit(benchmark::kMicrosecond);
BENCHMARK(photometricMeanFourLevels)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageEstimatedGreys)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageGivenGreys)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageGivenGreysMono)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageDistorted)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageNoisy)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageLargeObject)->Unit(benchmark::kMicrosecond);
BENCHMARK(coverageLargeObjectDistorted)->Unit(benchmark::kMicrosecond);
BENCHMARK(fourCorners)->Unit(benchmark::kMicrosecond);
BENCHMARK(fourCornersDistorted)->Unit(benchmark::kMicrosecond);
BENCHMARK(oneBlob)->Unit(benchmark::kMicrosecond);
BENCHMARK(mostSimilar)->Unit(benchmark::kMicrosecond);
BENCHMARK(kernelProjections)->Unit(benchmark::kMicrosecond);
BENCHMARK(fixed)->Unit(benchmark::kMicrosecond);
BENCHMARK(otsu)->Unit(benchmark::kMicrosecond);
BENCHMARK(adaptive)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
