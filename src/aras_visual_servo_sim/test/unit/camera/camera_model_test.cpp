#include "aras_visual_servo_sim/camera/camera_model.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/messages.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::camera_model_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // a few eps of numbers near 1
/** unproject promises 1e-12 of the image size, here 320 px, plus rounding of projecting again. */
constexpr double kRoundTrip = 1e-9;

/** Fails unless config throws a ParameterError whose text has the key in it. */
void expectFault(const CameraConfig& config, const std::string& key) {
  EXPECT_HAS(messageOf<ParameterError>([&] { CameraModel{config}; }), key);
}

template <typename Value>
void expectEachFault(Value CameraConfig::*member, const std::string& key, std::initializer_list<Value> values) {
  for (const Value& value : values) {
    CameraConfig config = cameraConfig();
    config.*member = value;
    expectFault(config, key);
  }
}

TEST(CameraModel, FieldOfViewGivesTheFocalLengthAndTheCentreIsHalfAPixelLess) {
  const CameraModel camera(cameraConfig());
  EXPECT_NEAR(camera.fx(), 160.0 / std::tan(0.705), kRounding * 200);
  EXPECT_EQ(camera.fx(), camera.fy());
  EXPECT_EQ(camera.cx(), 159.5);
  EXPECT_EQ(camera.cy(), 119.5);
}

TEST(CameraModel, PointOnTheAxisProjectsToThePrincipalPointAndXGoesRightYDown) {
  CameraConfig config = cameraConfig();
  config.cx_px = 100.25;
  config.cy_px = 77.5;
  const CameraModel camera(config);
  EXPECT_EQ(camera.project({0, 0, 2})->x(), 100.25);
  EXPECT_EQ(camera.project({0, 0, 2})->y(), 77.5);
  EXPECT_NEAR(camera.project({0.1, 0.2, 2})->x(), 100.25 + 0.05 * camera.fx(), kRounding * 200);
  EXPECT_NEAR(camera.project({0.1, 0.2, 2})->y(), 77.5 + 0.1 * camera.fy(), kRounding * 200);
}

TEST(CameraModel, NothingIsProjectedFromBehind) {
  const CameraModel camera(cameraConfig());
  EXPECT_FALSE(camera.project({0, 0, 0}));
  EXPECT_FALSE(camera.project({0.1, 0, -1}));
}

TEST(CameraModel, PlumbBobFollowsItsFormula) {
  CameraConfig config = distortedConfig();
  const CameraModel camera(config);
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const double radial = 1 - 0.3306 * r2 + 0.117 * r2 * r2;
  const Eigen::Vector2d d = camera.distort(x, y);
  EXPECT_NEAR(d.x(), x * radial + 2 * 0.001 * x * y - 0.0015 * (r2 + 2 * x * x), kRounding);
  EXPECT_NEAR(d.y(), y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.0015 * x * y, kRounding);
}

TEST(CameraModel, EquidistantWithoutCoefficientsIsTheAngle) {
  CameraConfig config = cameraConfig();
  config.distortion_model = "equidistant";
  const CameraModel camera(config);
  EXPECT_NEAR(camera.fx(), 320 / 1.41, kRounding * 300);
  const double angle = 0.6;
  EXPECT_NEAR(camera.project({0, std::sin(angle), std::cos(angle)})->y(), camera.cy() + camera.fy() * angle, 1e-10);
}

TEST(CameraModel, UnprojectUndoesProjectForEveryLens) {
  CameraConfig rational = cameraConfig(), fisheye = cameraConfig();
  rational.distortion_model = "rational_polynomial";
  rational.distortion = {0.2, 0.05, 0.001, 0.0005, 0.01, 0.35, 0.1, 0.01};
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  for (const CameraConfig& config : {cameraConfig(), distortedConfig(), rational, fisheye}) {
    SCOPED_TRACE(config.distortion_model);
    const CameraModel camera(config);
    for (double v = -0.5; v < 240; v += 11.9) {
      for (double u = -0.5; u < 320; u += 13.3) {
        const Eigen::Vector3d ray = camera.unproject(u, v);
        if (camera.lens() == CameraModel::Lens::kEquidistant) {
          ASSERT_NEAR(ray.norm(), 1.0, kRounding);
        } else {
          ASSERT_EQ(ray.z(), 1.0);
        }
        const auto again = camera.project(2.5 * ray);
        ASSERT_TRUE(again);
        ASSERT_NEAR(again->x(), u, kRoundTrip);
        ASSERT_NEAR(again->y(), v, kRoundTrip);
      }
    }
  }
}

TEST(CameraModel, UnprojectRejectsWhatIsNotFinite) {
  const CameraModel camera(cameraConfig());
  EXPECT_THROW(camera.unproject(kNan, 0), NotFiniteError);
  EXPECT_THROW(camera.unproject(0, kInfinity), NotFiniteError);
}

TEST(CameraModel, InfoMatricesAreThoseOfCameraInfo) {
  const CameraModel camera(distortedConfig());
  EXPECT_EQ(camera.distortionModel(), "plumb_bob");
  EXPECT_EQ(camera.D(), distortedConfig().distortion);
  EXPECT_EQ(camera.K()(0, 2), 159.5);
  EXPECT_EQ(camera.K()(1, 1), camera.fy());
  EXPECT_EQ(camera.P()(0, 0), camera.fx());
  EXPECT_EQ(camera.P()(2, 2), 1.0);
  EXPECT_EQ(camera.P().col(3).norm(), 0.0);
  EXPECT_EQ(CameraModel(cameraConfig()).D().size(), 5u);
  EXPECT_EQ(CameraModel(cameraConfig()).distortionModel(), "plumb_bob");
}

TEST(CameraModel, EveryBadArgumentIsNamed) {
  expectEachFault<int>(&CameraConfig::width, "width", {0, -1, 16385});
  expectEachFault<int>(&CameraConfig::height, "height", {0, -1, 16385});
  expectEachFault<double>(&CameraConfig::rate_hz, "rate_hz", {0.0, -1.0, kNan, kInfinity});
  expectEachFault<double>(&CameraConfig::near_m, "near_m", {0.0, -1.0, kNan, kInfinity});
  expectEachFault<double>(&CameraConfig::far_m, "far_m", {0.01, kNan, kInfinity});
  expectEachFault<double>(&CameraConfig::noise_stddev, "noise_stddev", {-0.1, kNan, kInfinity});
  expectEachFault<std::string>(&CameraConfig::encoding, "encoding", {"rgba8", ""});
  expectEachFault<std::string>(&CameraConfig::sampling, "sampling", {"middle", ""});
  expectEachFault<std::string>(&CameraConfig::distortion_model, "distortion_model", {"fisheye", ""});
  using Maybe = std::optional<double>;
  expectEachFault<Maybe>(&CameraConfig::horizontal_fov_rad, "horizontal_fov_rad",
                         {0.0, -1.0, M_PI, kNan, std::nullopt});
  expectEachFault<Maybe>(&CameraConfig::fx_px, "horizontal_fov_rad", {200.0});
  expectEachFault<Maybe>(&CameraConfig::cx_px, "cx_px", {kNan, kInfinity, 1e9});
  expectEachFault<Maybe>(&CameraConfig::cy_px, "cy_px", {kNan, -kInfinity, -1e9});
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    CameraConfig config = cameraConfig();
    config.horizontal_fov_rad.reset();
    config.fx_px = bad;
    config.fy_px = 200.0;
    expectFault(config, "fx_px");
    std::swap(config.fx_px, config.fy_px);
    expectFault(config, "fy_px");
  }
}

TEST(CameraModel, BadCoefficientsAreNamed) {
  CameraConfig config = distortedConfig();
  config.distortion.pop_back();
  expectFault(config, "distortion: found 4 coefficients");
  config.distortion = {0, 0, kNan, 0, 0};
  expectFault(config, "distortion: found [0, 0, .nan");
  config = cameraConfig();
  config.distortion = {0.1, 0, 0, 0, 0};
  expectFault(config, "only zeros for none");
  config.distortion_model = "plumb_bob";
  config.distortion = {-0.6, 0, 0, 0, 0};  // turns back at radius 1 / sqrt(1.8), inside the image
  expectFault(config, "folds over");
}

TEST(CameraModel, AllFaultsAreListedTogether) {
  CameraConfig config = cameraConfig();
  config.width = 0;
  config.encoding = "x";
  config.near_m = -1;
  expectFault(config, "width");
  expectFault(config, "encoding");
  expectFault(config, "near_m");
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::camera_model_test
