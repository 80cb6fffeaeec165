// Spheres, cylinders and cones: outlines and depths are those of the bodies, not of polyhedra.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>

#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::round_test {
namespace {

const double kInfinity = std::numeric_limits<double>::infinity();

MeshPtr meshOf(const RoundShape& shape, int segments = 32) {
  switch (shape.kind) {
    case RoundShape::Kind::kSphere:
      return makeSphere(shape.radius_m, segments);
    case RoundShape::Kind::kCylinder:
      return makeCylinder(shape.radius_m, shape.length_m, segments);
    default:
      return makeCone(shape.radius_m, shape.length_m, segments);
  }
}

/** Least s > 0 with o + s d on the front of a body in its own frame, by the equations of its parts; infinity if there
 * is none. */
double meeting(const RoundShape& shape, const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  const double r = shape.radius_m, half = 0.5 * shape.length_m, slope = r / std::max(shape.length_m, 1e-300);
  double least = kInfinity;
  // (x^2 + y^2) + c z^2 + e z = g
  const bool sphere = shape.kind == RoundShape::Kind::kSphere, cone = shape.kind == RoundShape::Kind::kCone;
  const double c = sphere ? 1.0 : cone ? -slope * slope : 0.0, e = cone ? 2.0 * slope * slope * half : 0.0;
  const double g = cone ? slope * slope * half * half : r * r;
  const double qa = d.head<2>().squaredNorm() + c * d.z() * d.z();
  const double qb = 2.0 * (o.head<2>().dot(d.head<2>()) + c * o.z() * d.z()) + e * d.z();
  const double qc = o.head<2>().squaredNorm() + c * o.z() * o.z() + e * o.z() - g;
  const double discriminant = qb * qb - 4.0 * qa * qc;
  if (discriminant >= 0.0) {
    const double stable = -0.5 * (qb + std::copysign(std::sqrt(discriminant), qb));
    for (const double s : {stable / qa, qc / stable}) {
      const double z = o.z() + s * d.z();
      const bool entering = 2.0 * qa * s + qb < 0.0;  // the left side falls below g: into the body
      if (s > 0.0 && entering && (sphere || std::abs(z) <= half)) least = std::min(least, s);
    }
  }
  for (const double side : {-1.0, 1.0}) {
    if (sphere || (cone && side > 0.0) || !(side * d.z() < 0.0)) continue;
    const double s = (side * half - o.z()) / d.z();
    if (s > 0.0 && (o + s * d).head<2>().norm() <= r) least = std::min(least, s);
  }
  return least;
}

struct View {
  CameraConfig config;
  CameraModel camera;  // copies share what takes long to make
  RoundShape shape;
  Pose X_WC, X_WB;

  Scene scene(const MeshPtr& mesh, Rgb color) const {
    Scene scene;
    scene.background = {255, 255, 255};
    Body body;
    body.name = "round";
    body.shapes.push_back({Pose{}, mesh, color, {}});
    body.X_WB = X_WB;
    scene.bodies.push_back(body);
    return scene;
  }
  double truth(const Eigen::Vector3d& ray_C) const {
    const Pose X_BC = X_WB.inverse() * X_WC;
    return meeting(shape, X_BC.p, X_BC.q * ray_C);
  }
};

/** Lenses, fields of view, distances from grazing to far, and attitudes, bodies partly out of view too. */
std::vector<View> views(const char* encoding = "mono8") {
  CameraConfig narrow = cameraConfig(), fisheye = cameraConfig(), rational = cameraConfig();
  narrow.horizontal_fov_rad = 0.35;
  fisheye.distortion_model = "equidistant";
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002};
  fisheye.horizontal_fov_rad = 3.6;
  rational.distortion_model = "rational_polynomial";
  rational.distortion = {0.2, 0.05, 0.001, 0.0005, 0.01, 0.35, 0.1, 0.01};
  using Kind = RoundShape::Kind;
  std::vector<CameraConfig> configs{cameraConfig(), narrow, distortedConfig(), rational, fisheye};
  for (CameraConfig& config : configs) {
    config.width = 160;
    config.height = 120;
    config.encoding = encoding;
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<View> views;
  for (const CameraConfig& config : configs) {
    const CameraModel camera(config);
    for (const RoundShape& shape : {RoundShape{Kind::kSphere, 0.1, 0.0}, RoundShape{Kind::kCylinder, 0.05, 0.3},
                                    RoundShape{Kind::kCylinder, 0.15, 0.01}, RoundShape{Kind::kCone, 0.1, 0.25}}) {
      for (const double distance : {0.03, 0.3, 1.5, 4.0}) {
        const double reach = std::hypot(shape.radius_m, 0.5 * shape.length_m);
        View view{config, camera, shape, {}, {}};
        view.X_WB.q =
            Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
        const double beside = 0.3 * (reach + distance) * std::min(1.0, *config.horizontal_fov_rad);
        view.X_WB.p = {beside * uniform(random), beside * uniform(random), reach + distance};
        views.push_back(view);
      }
    }
  }
  return views;
}

TEST(Round, DepthAndIdsAreThoseOfTheBody) {
  std::size_t seen = 0;
  for (const View& view : views()) {
    const CameraModel& camera = view.camera;
    GeometryRenderer renderer;
    GeometryImage image;
    renderer.render(camera, view.X_WC, view.scene(meshOf(view.shape), {}), image, Distance::kRange);
    double worst = 0.0;
    int wrong = 0;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const Eigen::Vector3d ray = camera.pixelRay(u, v);
        double range = view.truth(ray) * ray.norm();
        if (camera.showsLensCircle() && !camera.isWithinLens(u, v)) range = kInfinity;
        const bool there = range < kInfinity;
        wrong += there != (image.ids[image.at(u, v)] == 1);
        if (!there || image.ids[image.at(u, v)] != 1) continue;
        ++seen;
        worst = std::max(worst, std::abs(image.depth_m[image.at(u, v)] - range) / range);
      }
    }
    constexpr double kDepth = 1e-6;  // [-] float, and the root of a rounding at the rim
    EXPECT_LT(worst, kDepth) << view.config.distortion_model << " " << view.X_WB.p.z();
    EXPECT_LE(wrong, 1) << view.config.distortion_model << " " << view.X_WB.p.z();  // on the rim, by rounding
  }
  EXPECT_GT(seen, 25000u);
}

/** Black bodies before white: a pixel's value is what it sees of the background. */
TEST(Round, OutlinesAreWithinATwentiethOfAPixelOfThoseOfTheBody) {
  constexpr int kFine = 12;  // rays a side of a pixel that the outline crosses
  constexpr int kSectors = 16;
  constexpr double kBound = 0.05;     // [px]
  constexpr double kSampling = 0.11;  // of a pixel's area: 64 samples misjudge an edge by 1/16 at most, these by 1/24
  int sectors = 0;
  for (const View& view : views()) {
    const CameraModel& camera = view.camera;
    if (camera.showsLensCircle()) continue;
    const Image image = render(camera, view.X_WC, view.scene(meshOf(view.shape), {0, 0, 0}));
    std::vector<std::array<double, 3>> crossed;  // u, v, what the image has of the body more than there is
    double worst = 0.0;
    Eigen::Vector2d middle(0.0, 0.0);
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const auto seesBody = [&](double a, double b) {  // the ray between those through the pixel's corners
          const Eigen::Vector3d* top = camera.cornerRays().data() + v * (image.width + 1) + u;
          const Eigen::Vector3d* bottom = top + image.width + 1;
          const double s = a + 0.5, t = b + 0.5;
          return view.truth((1.0 - t) * ((1.0 - s) * top[0] + s * top[1]) +
                            t * ((1.0 - s) * bottom[0] + s * bottom[1])) < kInfinity;
        };
        int corners = 0;
        for (const double a : {-0.5, 0.5}) {
          for (const double b : {-0.5, 0.5}) corners += seesBody(a, b);
        }
        const double drawn = 1.0 - *image.pixel(u, v) / 255.0;
        if (corners == 4) {
          EXPECT_GT(drawn, 0.98);
        }
        // The outline may bulge into a pixel, or the body lie within it, without holding a corner.
        if (corners == 4 || (corners == 0 && drawn == 0.0)) continue;
        int inside = 0;
        for (int k = 0; k < kFine * kFine; ++k) {
          const double a = (k % kFine + 0.5) / kFine - 0.5, b = (k / kFine + 0.5) / kFine - 0.5;  // NOLINT
          inside += seesBody(a, b);
        }
        const double excess = drawn - double(inside) / (kFine * kFine);
        worst = std::max(worst, std::abs(excess));
        crossed.push_back({double(u), double(v), excess});
        middle += Eigen::Vector2d(u, v);
      }
    }
    EXPECT_LT(worst, kSampling) << view.config.distortion_model << " " << view.X_WB.p.z();
    if (crossed.size() < 60) continue;  // out of view, or nothing but a few pixels of it
    middle /= double(crossed.size());
    std::array<double, kSectors> excess{}, count{};
    for (const auto& [u, v, more] : crossed) {
      const double turn = std::atan2(v - middle.y(), u - middle.x()) / (2.0 * M_PI) + 0.5;
      const auto sector = static_cast<std::size_t>(turn * kSectors) % kSectors;
      excess[sector] += more;
      count[sector] += 1.0;
    }
    for (int k = 0; k < kSectors; ++k) {
      if (count[k] < 8.0) continue;
      ++sectors;
      EXPECT_LT(std::abs(excess[k]) / count[k], kBound) << view.config.distortion_model << " " << view.X_WB.p.z();
    }
  }
  EXPECT_GT(sectors, 100);
}

/** The triangles of the same body, 400 a turn: nothing of what draws it exactly. Made once for all views. */
MeshPtr trianglesOf(const RoundShape& shape, const TexturePtr& picture) {
  static std::map<std::tuple<RoundShape::Kind, double, double, TexturePtr>, MeshPtr> made;
  MeshPtr& mesh = made[{shape.kind, shape.radius_m, shape.length_m, picture}];
  if (!mesh) {
    auto triangles = std::make_shared<TriangleMesh>(*meshOf(shape, 400));
    triangles->round.reset();
    mesh = picture ? withPicture(*triangles, picture) : MeshPtr(triangles);
  }
  return mesh;
}

TEST(Round, LightAndPicturesLieAsOnTheirTriangles) {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 64 * 32; ++k) {
    const int s = k % 64, t = k / 64;
    for (const int part : {4 * s, 8 * t, 255 - 4 * s}) rgb.push_back(static_cast<std::uint8_t>(part));
  }
  const auto picture = std::make_shared<const Texture>("slope", 64, 32, rgb);
  std::size_t compared = 0;
  for (View& view : views("rgb8")) {
    if (view.X_WB.p.z() < 1.0) continue;  // nearer, light between corners of triangles is not what it is there
    const CameraModel& camera = view.camera;
    for (const bool pictured : {false, true}) {
      const MeshPtr round = pictured ? withPicture(*meshOf(view.shape), picture) : meshOf(view.shape);
      const Image exact = render(camera, view.X_WC, view.scene(round, {255, 180, 90}));
      const Image meshed =
          render(camera, view.X_WC, view.scene(trianglesOf(view.shape, pictured ? picture : nullptr), {255, 180, 90}));
      double sum = 0.0;
      std::size_t far_off = 0, drawn = 0;
      for (std::size_t i = 0; i < exact.data.size(); ++i) {
        const int difference = std::abs(int(exact.data[i]) - int(meshed.data[i]));
        drawn += exact.data[i] != 255;
        sum += difference;
        far_off += difference > 12;
      }
      if (drawn < 500) continue;
      compared += drawn;
      // Of what is drawn: outlines, the picture's seam, and texels of the triangles that lie askew.
      EXPECT_LT(sum / double(drawn), pictured ? 2.5 : 0.7) << view.config.distortion_model << view.X_WB.p.transpose();
      EXPECT_LT(double(far_off) / double(drawn), 0.03) << view.config.distortion_model << view.X_WB.p.transpose();
    }
  }
  EXPECT_GT(compared, 20000u);
}

TEST(Round, BodiesThatMeetHideEachOtherAlongTheirCurve) {
  // A black ball of 0.1 m, sunk to its middle into a white table, seen from above: a disc of its radius.
  const CameraModel camera(cameraConfig());
  const View view{cameraConfig(), camera, {RoundShape::Kind::kSphere, 0.1, 0.0}, lookingDown({0.02, 0.01, 0.5}), {}};
  Scene scene = view.scene(meshOf(view.shape), {0, 0, 0});
  Body table;
  table.name = "table";
  table.shapes.push_back({Pose{}, makeBox({2.0, 2.0, 0.1}), {255, 255, 255}, {}});
  table.X_WB.p = {0.0, 0.0, -0.05};
  scene.bodies.push_back(table);
  const Image image = render(camera, view.X_WC, scene);
  double area = 0.0;
  for (const std::uint8_t value : image.data) area += value < 100 ? 1.0 : 0.0;
  const double radius_px = camera.fx() * 0.1 / std::sqrt(0.5 * 0.5 - 0.1 * 0.1);  // of the tangent cone, seen askew
  EXPECT_NEAR(area / (M_PI * radius_px * radius_px), 1.0, 0.02);
  scene.bodies[0].X_WB.p.z() = -0.2;  // wholly below
  EXPECT_EQ(*render(camera, view.X_WC, scene).pixel(156, 122), *render(camera, view.X_WC, scene).pixel(150, 118));
}

TEST(Round, ACameraInsideSeesOutAndFarBodiesAreNotSeen) {
  const CameraModel camera(cameraConfig());
  for (const RoundShape& shape :
       {RoundShape{RoundShape::Kind::kSphere, 0.1, 0.0}, RoundShape{RoundShape::Kind::kCylinder, 0.1, 0.2},
        RoundShape{RoundShape::Kind::kCone, 0.1, 0.2}}) {
    View view{cameraConfig(), camera, shape, {}, {}};
    const auto blank = [&] {
      const Image image = render(camera, view.X_WC, view.scene(meshOf(shape), {0, 0, 0}));
      return std::all_of(image.data.begin(), image.data.end(), [](std::uint8_t x) { return x == 255; });
    };
    EXPECT_TRUE(blank());
    view.X_WB.p.z() = 1.0;
    EXPECT_FALSE(blank());
    view.X_WB.p.z() = 6.0;  // far_m is 5
    EXPECT_TRUE(blank());
    view.X_WB.p.z() = -1.0;
    EXPECT_TRUE(blank());
  }
}

TEST(Round, CenterSamplingGivesTwoValuesOnly) {
  CameraConfig config = cameraConfig();
  config.sampling = "center";
  const CameraModel camera(config);
  View view{config, camera, {RoundShape::Kind::kCylinder, 0.05, 0.2}, {}, {}};
  view.X_WB.p.z() = 0.5;
  view.X_WB.q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 0.3, 0.2).normalized());
  const Image image = render(camera, view.X_WC, view.scene(meshOf(view.shape), {0, 0, 0}));
  int black = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const bool there = view.truth(camera.pixelRay(u, v)) < kInfinity;
      ASSERT_EQ(*image.pixel(u, v), there ? 0 : 255) << u << " " << v;
      black += there;
    }
  }
  EXPECT_GT(black, 1000);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::round_test
