#include "shadow_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_sim {
namespace {

/** Rows x, y, z of a frame whose z is the direction, of length 1. Its axes turn the shortest way to those of the world,
 *  and about x if the direction is straight down. Eigen's FromTwoVectors does the same, but asks a singular value
 *  decomposition for the axis of half a turn, which takes longer to compile than all the rest of this folder. */
Eigen::Matrix3d frameAlong(const Eigen::Vector3d& direction) {
  const double cosine = direction.z();
  Eigen::Quaterniond turn;
  turn.vec() << direction.y(), -direction.x(), 0.0;
  constexpr double kAlmostOpposite = -1.0 + 1e-12;
  if (cosine > kAlmostOpposite) {
    const double twice_w = std::sqrt(2.0 * (1.0 + cosine));
    turn.w() = 0.5 * twice_w;
    turn.vec() *= 1.0 / twice_w;
  } else {
    const double w2 = 0.5 * std::max(1.0 + cosine, 0.0);
    turn.w() = std::sqrt(w2);
    if (turn.vec().isZero(1e-9)) turn.vec() = Eigen::Vector3d::UnitX();
    turn.vec() *= std::sqrt(1.0 - w2) / turn.vec().norm();
  }
  return turn.toRotationMatrix();
}

/** Rows s, t and the axis of face k of a cube map, as OpenGL has them. */
Eigen::Matrix3d faceOfCube(int k) {
  static const double kRows[ShadowView::kFaces][3][3] = {
      {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  Eigen::Matrix3d R;
  for (int row = 0; row < 3; ++row) R.row(row) = Eigen::Map<const Eigen::RowVector3d>(kRows[k][row]);
  return R;
}

/** To coordinates and depth, each 0 .. 1, of a pyramid along z. @param wide  tangent of half its angle */
Eigen::Matrix4d perspective(double wide, double near, double far) {
  Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
  S(0, 0) = S(1, 1) = 0.5 / wide;
  S(0, 2) = S(1, 2) = 0.5;
  S(2, 2) = far / (far - near);
  S(2, 3) = -near * far / (far - near);
  S(3, 2) = 1.0;
  return S;
}

/** From the world to a frame at p_W. @param R  its axes, as rows */
Eigen::Matrix4d toFrame(const Eigen::Matrix3d& R, const Eigen::Vector3d& p_W) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Identity();
  X.topLeftCorner<3, 3>() = R;
  X.topRightCorner<3, 1>() = -R * p_W;
  return X;
}

/** Tangent of half the angle of a spot's map, a little wider than its light. */
double widthOf(const Light& spot) { return std::tan(std::min(0.5 * spot.outer_angle_rad + 0.02, 1.5)); }

}  // namespace

std::array<double, 17> Caster::key() const {
  std::array<double, 17> key;
  key[0] = static_cast<double>(serial);
  std::copy(X_WS.data(), X_WS.data() + 16, key.begin() + 1);
  return key;
}

std::vector<Caster> castersOf(const Scene& scene) {
  constexpr double kStep = 1.0 / (1 << 30);
  std::vector<Caster> casters;
  for (const Body& body : scene.bodies) {
    if (!body.visible || !body.casts_shadows) continue;
    for (const Shape& shape : body.shapes) {
      if (shape.material.opacity < 1.0) continue;
      Eigen::Matrix4d X_WS = (body.X_WB * shape.X_BS).matrix();
      X_WS = X_WS.unaryExpr([](double value) { return std::nearbyint(value / kStep) * kStep; });
      const Eigen::Vector4d center_W = X_WS * shape.mesh->center().homogeneous();
      casters.push_back({&shape.mesh, X_WS, center_W.head<3>(), shape.mesh->radius(), 0});
    }
  }
  return casters;
}

std::vector<const Caster*> reachedBy(const Light& light, const std::vector<Caster>& casters) {
  std::vector<const Caster*> chosen;
  const Eigen::Vector3d axis = light.direction_W.normalized();
  for (const Caster& caster : casters) {
    const Eigen::Vector3d ray = caster.center_W - light.position_W;
    bool reached = true;
    if (light.type != Light::Type::kDirectional) reached = ray.norm() < light.range_m + caster.radius_m;
    if (light.type == Light::Type::kSpot && reached) {  // the ball and the cone about the map's pyramid
      const double wide = std::sqrt(2.0) * widthOf(light), along = axis.dot(ray);
      const double across = (ray - along * axis).norm();
      reached =
          along + caster.radius_m > 0.0 && across - wide * along <= caster.radius_m * std::sqrt(1.0 + wide * wide);
    }
    if (reached) chosen.push_back(&caster);
  }
  return chosen;
}

ShadowView::ShadowView(const Light& light, const std::vector<const Caster*>& casters, int side)
    : directional(light.type == Light::Type::kDirectional),
      cube(light.type == Light::Type::kPoint),
      light_W(light.position_W) {
  if (directional) {
    placeDirectional(light, casters, side);
    return;
  }
  width = height = cube ? std::max(1, side / 2) : side;
  Eigen::Matrix3d R_LW = Eigen::Matrix3d::Identity();
  if (!cube) R_LW = frameAlong(light.direction_W.normalized());
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
  for (const Caster* caster : casters) {
    const Eigen::Vector3d ray = caster->center_W - light.position_W;
    const double distance = cube ? ray.norm() : R_LW.row(2).dot(ray);
    nearest = std::min(nearest, distance - caster->radius_m);
    farthest = std::max(farthest, distance + caster->radius_m);
  }
  far = std::max(1.01 * std::min(farthest, light.range_m), 1e-3);
  // Half: a thing in the corner of a cube's face is 1 / sqrt(3) of its distance before that face.
  near = std::clamp(0.5 * nearest, 1e-3 * far, 0.5 * far);
  const double wide = cube ? 1.0 : widthOf(light);
  const Eigen::Matrix4d X_LW = toFrame(R_LW, light.position_W);
  of_world = cube ? X_LW : Eigen::Matrix4d(perspective(wide, near, far) * X_LW);
  texel = 2.0 * wide / width;
}

void ShadowView::placeDirectional(const Light& light, const std::vector<const Caster*>& casters, int side) {
  const Eigen::Matrix3d R_LW = frameAlong(light.direction_W.normalized());
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(infinity), high = -low;
  for (const Caster* caster : casters) {
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector4d corner_S = (*caster->mesh)->corner(k).homogeneous();
      const Eigen::Vector3d p_L = R_LW * (caster->X_WS * corner_S).head<3>();
      low = low.cwiseMin(p_L);
      high = high.cwiseMax(p_L);
    }
  }
  if (casters.empty()) low = high = Eigen::Vector3d::Zero();
  constexpr double kRim = 4.0;  // [px] beyond the things, for soft edges
  Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
  const double widest = std::max({high.x() - low.x(), high.y() - low.y(), 1e-6});
  constexpr double kThinnest_m = 2e-3;  // so that what is drawn behind its place for rounding is still within the map
  const double depth = std::max(high.z() - low.z(), kThinnest_m);
  texel = widest / (side - 2.0 * kRim);
  const auto texelsOf = [&](double length) {
    constexpr int kStep = 128;  // [px] so that things which turn seldom ask for another size
    const double texels = length / texel + 2.0 * kRim;
    return std::min(side, kStep * static_cast<int>(std::ceil(texels / kStep)));
  };
  width = texelsOf(high.x() - low.x());
  height = texelsOf(high.y() - low.y());
  const double size_x = texel * width, size_y = texel * height;
  const Eigen::Vector3d middle = 0.5 * (low + high);
  S.block<1, 3>(0, 0) = R_LW.row(0) / size_x;
  S.block<1, 3>(1, 0) = R_LW.row(1) / size_y;
  S.block<1, 3>(2, 0) = R_LW.row(2) / (1.02 * depth);
  S.col(3) << 0.5 - middle.x() / size_x, 0.5 - middle.y() / size_y, 0.5 - middle.z() / (1.02 * depth), 1.0;
  of_world = S;
}

MapBox ShadowView::boxOf(const Caster& caster) const {
  MapBox box;
  const Eigen::Matrix4d of_mesh = of_world * caster.X_WS;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector4d corner_S = (*caster.mesh)->corner(k).homogeneous();
    box.add((of_mesh * corner_S).head<3>());
  }
  constexpr double kAround =
      kLift + 2.5;  // [texels]: the lift, a tap beside the place and what it is interpolated with
  const Eigen::Array3d around(kAround / width, kAround / height, kLift * texel * of_world.row(2).head<3>().norm());
  box.low -= around;
  box.high += around;
  return box;
}

Eigen::Matrix4d ShadowView::ofFace(int k) const {
  return perspective(1.0, near, far) * toFrame(faceOfCube(k), Eigen::Vector3d::Zero()) * of_world;
}

bool ShadowView::isOnFace(int k, const Caster& caster) const {  // the ball and the four sides of the pyramid
  const Eigen::Vector3d p = faceOfCube(k) * (of_world * caster.center_W.homogeneous()).head<3>();
  return std::max(std::abs(p.x()), std::abs(p.y())) - p.z() < std::sqrt(2.0) * caster.radius_m;
}

}  // namespace aras_visual_servo_sim
