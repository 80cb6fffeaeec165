#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>

#include "aras_visual_servo_camera/config/sections.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "text_of.hpp"

namespace aras_visual_servo_camera::camera_intrinsics_test {
namespace {

const std::array<double, 9> kK{195.05, 0, 150.0, 0, 190.0, 130.0, 0, 0, 1};
constexpr double kRoundTrip = 1e-10;  // pixels: Newton stops at 1e-13 normalised, f = 195 px, some roundings
constexpr double kStep = 1e-4;        // pixels, of the central difference
constexpr double kDifference = 1e-8;  // per pixel: truncation h^2, rounding eps / h = 2e-12

struct Lens {
  const char* model;
  std::vector<double> D;
};

const std::vector<Lens> kLenses{{"none", {}},
                                {"plumb_bob", {-0.3306, 0.117, 0.001, -0.002, 0.0}},
                                {"plumb_bob", {0.1, -0.05, 0.0, 0.0}},
                                {"rational_polynomial", {0.2, 0.1, 0.001, -0.001, 0.02, 0.4, 0.15, 0.01}},
                                {"equidistant", {0.02, -0.01, 0.003, -0.001}},
                                {"equidistant", {0.0, 0.0, 0.0, 0.0}}};

TEST(CameraIntrinsics, UndistortIsTheInverseOfProject) {
  for (const Lens& lens : kLenses) {
    const CameraIntrinsics camera(320, 240, kK, lens.model, lens.D);
    for (double u : {0.0, 77.25, 150.0, 319.0}) {
      for (double v : {0.0, 130.0, 201.5, 239.0}) {
        const auto ray = camera.undistort(u, v);
        ASSERT_TRUE(ray.valid) << lens.model << " " << u << " " << v;
        const auto back = camera.project(ray.x, ray.y);
        EXPECT_NEAR(back[0], u, kRoundTrip) << lens.model;
        EXPECT_NEAR(back[1], v, kRoundTrip) << lens.model;
      }
    }
  }
}

TEST(CameraIntrinsics, JacobianIsTheDifferenceQuotientOfUndistort) {
  for (const Lens& lens : kLenses) {
    const CameraIntrinsics camera(320, 240, kK, lens.model, lens.D);
    for (const auto& [u, v] : std::vector<std::pair<double, double>>{{20, 30}, {151, 131}, {300, 70}}) {
      const auto ray = camera.undistort(u, v);
      const auto right = camera.undistort(u + kStep, v), left = camera.undistort(u - kStep, v);
      const auto below = camera.undistort(u, v + kStep), above = camera.undistort(u, v - kStep);
      EXPECT_NEAR(ray.jacobian[0], (right.x - left.x) / (2 * kStep), kDifference) << lens.model;
      EXPECT_NEAR(ray.jacobian[1], (below.x - above.x) / (2 * kStep), kDifference) << lens.model;
      EXPECT_NEAR(ray.jacobian[2], (right.y - left.y) / (2 * kStep), kDifference) << lens.model;
      EXPECT_NEAR(ray.jacobian[3], (below.y - above.y) / (2 * kStep), kDifference) << lens.model;
    }
  }
}

TEST(CameraIntrinsics, IdealLensIsThePinholeFormula) {
  const CameraIntrinsics camera(320, 240, kK, "plumb_bob", {0, 0, 0, 0, 0});
  EXPECT_FALSE(camera.distorted());
  const auto ray = camera.undistort(20.0, 30.0);
  EXPECT_DOUBLE_EQ(ray.x, (20.0 - 150.0) / 195.05);
  EXPECT_DOUBLE_EQ(ray.y, (30.0 - 130.0) / 190.0);
}

TEST(CameraIntrinsics, EquidistantLensMapsAngleToRadius) {
  const CameraIntrinsics camera(320, 240, kK, "equidistant", {0, 0, 0, 0});
  EXPECT_TRUE(camera.distorted());
  const double theta = 0.7;
  EXPECT_NEAR(camera.project(std::tan(theta), 0.0)[0], 150.0 + 195.05 * theta, kRoundTrip);
}

TEST(CameraIntrinsics, AFisheyeHasCoordinatesUpToTheWidestAngleOnly) {
  const double f = 100.0;
  const CameraIntrinsics camera(400, 400, {f, 0, 199.5, 0, f, 199.5, 0, 0, 1}, "equidistant", {0, 0, 0, 0});
  for (const double theta : {0.1, 0.9, 1.3, 1.39}) {
    const auto ray = camera.undistort(199.5 + f * theta * 0.6, 199.5 + f * theta * 0.8);
    ASSERT_TRUE(ray.valid) << theta;
    EXPECT_NEAR(ray.x / (0.6 * std::tan(theta)), 1.0, 1e-11);
    EXPECT_NEAR(ray.y / (0.8 * std::tan(theta)), 1.0, 1e-11);
  }
  for (const double theta : {1.40, 1.5707963, 1.6, 1.75})  // 80 degrees are 1.3963
    EXPECT_FALSE(camera.undistort(199.5 + f * theta, 199.5).valid) << theta;
}

TEST(CameraIntrinsics, PixelsBeyondTheFoldOfTheLensHaveNoRay) {
  // r (1 - 0.8 r^2) grows up to r = 0.645, where it is 0.43: no ray is bent to 0.8.
  const CameraIntrinsics camera(320, 240, kK, "plumb_bob", {-0.8, 0, 0, 0});
  EXPECT_TRUE(camera.undistort(150.0 + 0.3 * 195.05, 130.0).valid);
  EXPECT_FALSE(camera.undistort(150.0 + 0.8 * 195.05, 130.0).valid);
}

// A calibration of a depth camera with 4K. Rays at r = 0.8937 are drawn at 0.7889, those farther from the axis nearer
// to it until r = 1.063, and from there on farther again: the image, which reaches 1.2, has third rays beyond 0.71.
const std::vector<double> kFolding{0.44, -2.62, 4e-4, -3e-4, 1.41, 0.34, -2.3, 1.27};
constexpr double kFoldRay = 0.8937, kFold = 0.7889, kFocal = 1825.0;
constexpr double kTangential = 2e-3;  // largest shift by the tangential coefficients

CameraIntrinsics folding(int width = 3840, int height = 2160, int pixels = 1) {
  return {width / pixels,
          height / pixels,
          {kFocal / pixels, 0, 0.5 * width / pixels, 0, kFocal / pixels, 0.5 * height / pixels, 0, 0, 1},
          "rational_polynomial",
          kFolding};
}

TEST(CameraIntrinsics, ARationalLensThatFoldsInsideTheImageHasRaysUpToItsFoldOnly) {
  const CameraIntrinsics camera = folding();
  int seen = 0, blind = 0;
  for (int u = 0; u < camera.width(); u += 40) {
    for (int v = 0; v < camera.height(); v += 40) {
      const double rd = std::hypot(u - camera.cx(), v - camera.cy()) / kFocal;
      const auto ray = camera.undistort(u, v);
      EXPECT_FALSE(ray.valid && rd > kFold + kTangential) << u << " " << v;
      EXPECT_TRUE(ray.valid || rd > 0.99 * kFold) << u << " " << v;
      EXPECT_EQ(camera.rayOf(u, v).solid_angle > 0.0, ray.valid);
      ++(ray.valid ? seen : blind);
      if (!ray.valid) continue;
      EXPECT_LE(std::hypot(ray.x, ray.y), kFoldRay + 1e-4);
      EXPECT_TRUE(camera.isWithinFold(ray.x, ray.y));
      const auto back = camera.project(ray.x, ray.y);
      EXPECT_NEAR(back[0], u, 1e-9);
      EXPECT_NEAR(back[1], v, 1e-9);
    }
  }
  EXPECT_GT(seen, 3000);
  EXPECT_GT(blind, 500);
  EXPECT_FALSE(camera.isWithinFold(0.0, 0.9));
}

TEST(CameraIntrinsics, TheRadiusOfTheFoldIsToldWhereItIsInTheImage) {
  const double radius = kFold * kFocal;
  EXPECT_NEAR(folding().foldRadius(), radius, 0.2);
  EXPECT_NE(folding().foldWarning().find(" 1440 px"), std::string::npos) << folding().foldWarning();
  EXPECT_NEAR(folding(3840, 2160, 4).foldRadius(), radius / 4, 0.1);
  for (const CameraIntrinsics& whole :
       {folding(1920, 1080), CameraIntrinsics(320, 240, kK, "plumb_bob", {0.1, -0.05, 0, 0}),
        CameraIntrinsics(320, 240, kK, "equidistant", {0.02, -0.01, 0.003, -0.001})}) {
    EXPECT_TRUE(std::isinf(whole.foldRadius()));
    EXPECT_EQ(whole.foldWarning(), "");
  }
  // r (1 - 0.8 r^2) grows up to r = 0.645, theta (1 - 0.3 theta^2) up to theta = 1.054.
  EXPECT_NEAR(
      CameraIntrinsics(320, 240, {195.05, 0, 150, 0, 195.05, 130, 0, 0, 1}, "plumb_bob", {-0.8, 0, 0, 0}).foldRadius(),
      195.05 * 0.6455 * (1 - 0.8 * 0.6455 * 0.6455), 0.1);
  EXPECT_NEAR(
      CameraIntrinsics(320, 240, {195.05, 0, 20, 0, 195.05, 130, 0, 0, 1}, "equidistant", {-0.3, 0, 0, 0}).foldRadius(),
      195.05 * 1.054 * (1 - 0.3 * 1.054 * 1.054), 0.1);
}

/** Newton's method from the pixel itself goes astray at some of these. */
TEST(CameraIntrinsics, EveryRayWithinTheFoldIsFound) {
  const CameraIntrinsics camera(640, 480, {300, 0, 319.5, 0, 300, 239.5, 0, 0, 1}, "plumb_bob", {1.6, -1.2, 0, 0, 0.2});
  for (double r = 0.02; r < 3.0; r += 0.02) {
    if (!camera.isWithinFold(r, 0.0)) break;
    const auto pixel = camera.project(0.6 * r, 0.8 * r);
    const auto ray = camera.undistort(pixel[0], pixel[1]);
    ASSERT_TRUE(ray.valid) << r;
    EXPECT_NEAR(std::hypot(ray.x, ray.y), r, 1e-6);
  }
}

std::string faultsOf(const std::array<double, 9>& K, const std::string& model, const std::vector<double>& D,
                     int width = 320, int height = 240) {
  return testing::textOf<ParameterError>([&] { CameraIntrinsics(width, height, K, model, D); });
}

TEST(CameraIntrinsics, UncalibratedCameraIsRefusedWithEveryFault) {
  const std::string faults = faultsOf({}, "plumb_bob", {});
  for (const char* key : {"K[0]", "K[4]", "K[8]"}) EXPECT_NE(faults.find(key), std::string::npos) << faults;
}

TEST(CameraIntrinsics, EachBadEntryIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (double bad : {0.0, -195.0, nan, inf}) {
    auto K = kK;
    K[0] = bad;
    EXPECT_NE(faultsOf(K, "none", {}).find("fx"), std::string::npos) << bad;
    K = kK;
    K[4] = bad;
    EXPECT_NE(faultsOf(K, "none", {}).find("fy"), std::string::npos) << bad;
  }
  for (int k : {2, 5}) {
    auto K = kK;
    K[k] = nan;
    EXPECT_NE(faultsOf(K, "none", {}).find("K[" + std::to_string(k) + "]"), std::string::npos);
  }
  auto skewed = kK;
  skewed[1] = 0.5;
  EXPECT_NE(faultsOf(skewed, "none", {}).find("K[1]"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "none", {}, 0).find("width"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "none", {}, 320, -1).find("height"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "brown", {0.1}).find("distortion_model"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "plumb_bob", {0.1}).find("D"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "rational_polynomial", {0.1, 0, 0, 0, 0}).find("D"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "equidistant", {0.1, 0, 0, 0, 0}).find("D"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "plumb_bob", {0.1, nan, 0, 0}).find("camera_info.D: found nan"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "", {0.1}).find("D"), std::string::npos);
  EXPECT_EQ(faultsOf(kK, "", {0, 0, 0, 0, 0}), "");
}

/** Numbers that made features which counted as valid and were not finite. */
TEST(CameraIntrinsics, NumbersThatNoLensHasAreRefused) {
  for (const auto& [k, bad] : std::vector<std::pair<int, double>>{
           {0, 1e-308}, {0, 1.0}, {0, 6.3}, {4, 330e3}, {4, 1e300}, {2, 1e18}, {2, -2e7}, {5, 1e300}, {5, 2e7}}) {
    auto K = kK;
    K[k] = bad;
    EXPECT_NE(faultsOf(K, "none", {}).find("K[" + std::to_string(k) + "]"), std::string::npos) << bad;
  }
  EXPECT_NE(faultsOf(kK, "plumb_bob", {1e300, 0, 0, 0}).find("camera_info.D"), std::string::npos);
  EXPECT_NE(faultsOf(kK, "none", {}, 40000).find("camera_info.width"), std::string::npos);
  EXPECT_EQ(faultsOf({656, 0, 1e7, 0, 3.2e7, -1e7, 0, 0, 1}, "plumb_bob", {1e6, -1e6, 0, 0}, 32768, 1), "");
}

TEST(CameraIntrinsics, AKThatIsNoCalibrationIsRefused) {
  const std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1}, parts{0.78, 0, 0.5, 0, 1.04, 0.5, 0, 0, 1};
  for (const auto& K : {identity, parts}) {
    for (const int side : {4, 40, 640, 4000}) {
      const std::string faults = faultsOf(K, "none", {}, side, side);
      EXPECT_NE(faults.find("K[0] (fx)"), std::string::npos) << side;
      EXPECT_EQ(faults.find("K[4] (fy)") != std::string::npos, side > 40 || K == identity) << side;
    }
  }
}

TEST(CameraIntrinsics, NoLensHasCoordinatesBeyondTheWidestAngle) {
  for (const Lens& lens : std::vector<Lens>{{"none", {}}, {"plumb_bob", {1e-3, 0, 0, 0}}}) {
    const CameraIntrinsics camera(640, 480, {25, 0, 319.5, 0, 25, 239.5, 0, 0, 1}, lens.model, lens.D);
    EXPECT_TRUE(camera.undistort(319.5 + 25 * 5.5, 239.5).valid) << lens.model;  // tan of 80 degrees is 5.67
    EXPECT_FALSE(camera.undistort(319.5 + 25 * 6.5, 239.5).valid) << lens.model;
    const PixelMap map(camera);
    EXPECT_TRUE(map.sees(320, 240));
    EXPECT_FALSE(map.sees(0, 0));
  }
}

TEST(CameraIntrinsics, PrincipalPointOutsideTheImageIsAllowed) {
  auto K = kK;
  K[2] = -40.0;
  EXPECT_EQ(faultsOf(K, "none", {}), "");
}

TEST(CameraIntrinsics, AreEqualIfEveryNumberIs) {
  const auto camera = [](int width, int height, double fx, double fy, double cx, double cy, const char* model,
                         std::vector<double> D) {
    return CameraIntrinsics(width, height, {fx, 0, cx, 0, fy, cy, 0, 0, 1}, model, D);
  };
  const CameraIntrinsics one = camera(320, 240, 200, 210, 160, 120, "plumb_bob", {0.1, 0, 0, 0});
  EXPECT_TRUE(one == camera(320, 240, 200, 210, 160, 120, "rational_polynomial", {0.1, 0, 0, 0, 0, 0, 0, 0}));
  for (const CameraIntrinsics& other : {camera(321, 240, 200, 210, 160, 120, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 241, 200, 210, 160, 120, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 240, 201, 210, 160, 120, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 240, 200, 211, 160, 120, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 240, 200, 210, 161, 120, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 240, 200, 210, 160, 121, "plumb_bob", {0.1, 0, 0, 0}),
                                        camera(320, 240, 200, 210, 160, 120, "equidistant", {0.1, 0, 0, 0}),
                                        camera(320, 240, 200, 210, 160, 120, "plumb_bob", {0.1, 0, 0, 0.01})})
    EXPECT_FALSE(one == other);
}

TEST(CameraInfo, IsReadFromAMapping) {
  const auto node = YAML::Load(
      "{width: 320, height: 240, K: [195.05, 0, 150, 0, 190, 130, 0, 0, 1], D: [], distortion_model: plumb_bob, "
      "frame_id: camera, P: [], R: []}");
  EXPECT_TRUE(readCameraInfo(node) == CameraIntrinsics(320, 240, kK, "plumb_bob", {}));
}

constexpr char kSensor[] =
    "width: 2560, height: 1920, K: [2000, 0, 1279.5, 0, 1900, 959.5, 0, 0, 1], D: [-0.2, 0.1, 0, 0], "
    "distortion_model: plumb_bob";

CameraIntrinsics readOut(const std::string& more) {
  return readCameraInfo(YAML::Load("{" + std::string(kSensor) + more + "}"));
}

TEST(CameraInfo, ABinnedPixelLooksWhereThePixelsItIsMadeOfDo) {
  const CameraIntrinsics sensor = readOut("");
  const CameraIntrinsics image = readOut(
      ", binning_x: 4, binning_y: 2, roi: {x_offset: 640, y_offset: 480, width: 1600, height: 1200, do_rectify: "
      "false}");
  EXPECT_EQ(image.width(), 400);
  EXPECT_EQ(image.height(), 600);
  for (const double u : {0.0, 17.0, 399.0}) {
    for (const double v : {0.0, 300.0, 599.0}) {
      const auto ray = image.undistort(u, v), same = sensor.undistort(640 + 4 * u + 1.5, 480 + 2 * v + 0.5);
      EXPECT_NEAR(ray.x, same.x, 1e-12);
      EXPECT_NEAR(ray.y, same.y, 1e-12);
    }
  }
}

TEST(CameraInfo, OfTheWholeSensorIsLeftAsItIs) {
  EXPECT_TRUE(readOut("") == readOut(", binning_x: 1, binning_y: 0, roi: {width: 2560, height: 1920}"));
}

TEST(CameraInfo, ARegionOutsideTheSensorAndABinnedKOfAnotherSizeAreRefused) {
  const auto faults = [](const std::string& more) { return testing::textOf<ParameterError>([&] { readOut(more); }); };
  EXPECT_NE(faults(", roi: {x_offset: 1, width: 2560, height: 1920}").find("camera_info.roi.x_offset"),
            std::string::npos);
  EXPECT_NE(faults(", roi: {y_offset: 1}").find("camera_info.roi.y_offset"), std::string::npos);
  EXPECT_NE(faults(", binning_x: 2561").find("camera_info.binning_x"), std::string::npos);
  EXPECT_NE(faults(", roi: {x: 3}").find("camera_info.roi.x"), std::string::npos);
  CameraInfoConfig huge;  // as a message may have it, which no schema has checked
  huge.width = 640;
  huge.height = 480;
  huge.K = {500, 0, 320, 0, 500, 240, 0, 0, 1};
  huge.roi.x_offset = huge.roi.width = 1 << 30;
  EXPECT_NE(testing::textOf<ParameterError>([&] { intrinsicsOf(huge); }).find("camera_info.roi.x_offset"),
            std::string::npos);
  const std::string binned = testing::textOf<ParameterError>([] {
    readCameraInfo(
        YAML::Load("{width: 640, height: 480, K: [2000, 0, 1279.5, 0, 2000, 959.5, 0, 0, 1], D: [], "
                   "distortion_model: '', binning_x: 4, binning_y: 4}"));
  });
  EXPECT_NE(binned.find("camera_info.width: found 640"), std::string::npos) << binned;
  EXPECT_NE(binned.find("camera_info.height: found 480"), std::string::npos) << binned;
}

TEST(CameraInfo, MissingAndUnknownKeysAreAllListed) {
  const std::string faults = testing::textOf<ParameterError>(
      [] { readCameraInfo(YAML::Load("{width: 320, K: [1, 2], D: [], distortion_model: none, focal: 3}")); });
  for (const char* key : {"height", ".K", "focal"}) EXPECT_NE(faults.find(key), std::string::npos) << faults;
}

}  // namespace
}  // namespace aras_visual_servo_camera::camera_intrinsics_test
