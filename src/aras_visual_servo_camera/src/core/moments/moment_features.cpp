#include "aras_visual_servo_camera/moments/moment_features.hpp"

#include <visp3/core/vpMomentAreaNormalized.h>
#include <visp3/core/vpMomentBasic.h>
#include <visp3/core/vpMomentCentered.h>
#include <visp3/core/vpMomentDatabase.h>
#include <visp3/core/vpMomentGravityCenter.h>
#include <visp3/core/vpMomentGravityCenterNormalized.h>
#include <visp3/core/vpMomentObject.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"

namespace aras_visual_servo_camera {
namespace {

// Third-order moments whose direction agrees with the reference's, or with the opposite one, by less than this (cosine)
// do not tell alpha from alpha + pi. A view that differs so much from the reference is treated like a symmetric one.
constexpr double kMinAgreement = 0.1;
// Asymmetry that the stairs of a hard-edged shape of n pixels put on, at most: kStairs / n^(3/4). Measured over all
// angles of shapes of 12 to 150 px: 0.11 at 12 px, 0.02 at 40 px.
constexpr double kStairs = 3.0;

/** In (-pi, pi]. */
double wrapped(double angle) {
  const double rest = std::remainder(angle, 2.0 * M_PI);
  return rest <= -M_PI ? rest + 2.0 * M_PI : rest;
}

/** alpha or alpha + pi, whichever is nearer to `target`, in (-pi, pi]. */
double nearestBranch(double alpha, double target) {
  return wrapped(std::abs(wrapped(alpha - target)) <= 0.5 * M_PI ? alpha : alpha + M_PI);
}

ThirdMoments thirdOf(const std::vector<double>& mu) {
  return {mu[momentIndex(3, 0)], mu[momentIndex(2, 1)], mu[momentIndex(1, 2)], mu[momentIndex(0, 3)]};
}

ThirdMoments scaled(ThirdMoments t, double factor) {
  for (double& value : t) value *= factor;
  return t;
}

}  // namespace

ThirdMoments rotated(const ThirdMoments& t, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  // x' = c x + s y, y' = -s x + c y, expanded.
  return {
      c * c * c * t[0] + 3 * c * c * s * t[1] + 3 * c * s * s * t[2] + s * s * s * t[3],
      -c * c * s * t[0] + (c * c * c - 2 * c * s * s) * t[1] + (2 * c * c * s - s * s * s) * t[2] + c * s * s * t[3],
      c * s * s * t[0] + (s * s * s - 2 * c * c * s) * t[1] + (c * c * c - 2 * c * s * s) * t[2] + c * c * s * t[3],
      -s * s * s * t[0] + 3 * c * s * s * t[1] - 3 * c * c * s * t[2] + c * c * c * t[3]};
}

double dot(const ThirdMoments& a, const ThirdMoments& b) {
  return a[0] * b[0] + 3.0 * a[1] * b[1] + 3.0 * a[2] * b[2] + a[3] * b[3];
}

/** ViSP's moments of one object, computed in the order of their dependencies (ViSP leaves that to the caller). */
struct FeatureBuilder::VispMoments {
  /** A vpMomentObject whose moments are handed over: vpMomentObject::fromImage sums in an order that varies and assumes
   * a constant pixel area. */
  struct HandedMomentObject : vpMomentObject {
    explicit HandedMomentObject(int order) : vpMomentObject(static_cast<unsigned>(order)) {
      setType(DENSE_FULL_OBJECT);
    }
    using vpMomentObject::set;
  };

  explicit VispMoments(int order) : object(order), area(1.0, 1.0) {
    for (vpMoment* moment : std::initializer_list<vpMoment*>{&basic, &gravity, &centred, &area, &gravity_normalised})
      moment->linkTo(database);
  }

  /** Computes the centroid and the centred moments. @param m  the sequence of moments.hpp */
  void update(const std::vector<double>& m) {
    forEachMoment([&](unsigned i, unsigned j) { object.set(i, j, m[momentIndex(i, j)]); });
    database.updateAll(object);
    basic.compute();
    gravity.compute();
    centred.compute();
  }

  /** Returns the centred moments in the sequence of moments.hpp. */
  std::vector<double> mu() const {
    std::vector<double> mu;
    forEachMoment([&](unsigned i, unsigned j) { mu.push_back(centred.get(i, j)); });
    return mu;
  }

  /** Computes the normalised features, after update(). */
  void normalise(const Reference& reference) {
    area.setDesiredArea(reference.area_star);
    area.setDesiredDepth(reference.z_star_m);  // ViSP's default of 1 would scale all three by 1 / Z*
    area.compute();
    gravity_normalised.compute();
  }

  template <class Act>
  void forEachMoment(Act act) const {
    for (unsigned n = 0; n <= object.getOrder(); ++n)
      for (unsigned j = 0; j <= n; ++j) act(n - j, j);
  }

  HandedMomentObject object;
  vpMomentDatabase database;
  vpMomentBasic basic;
  vpMomentGravityCenter gravity;
  vpMomentCentered centred;
  vpMomentAreaNormalized area;
  vpMomentGravityCenterNormalized gravity_normalised;
};

FeatureBuilder::FeatureBuilder(int order, double asymmetry_threshold, double orientation_threshold)
    : visp_(std::make_unique<VispMoments>(order)),
      asymmetry_threshold_(asymmetry_threshold),
      orientation_threshold_(orientation_threshold),
      names_(momentNames(order)) {}

FeatureBuilder::~FeatureBuilder() = default;

double FeatureBuilder::resolveAlpha(double alpha, const ThirdMoments& mu3, double asymmetry, double noise,
                                    bool* symmetric) {
  Reference& reference = *reference_;
  const double norm = std::sqrt(dot(mu3, mu3));
  *symmetric = *symmetric || reference.symmetric;
  if (!*symmetric && !reference.mu3_direction) {
    alpha = nearestBranch(alpha, reference.alpha_star);
    reference.mu3_direction = scaled(rotated(mu3, alpha), 1.0 / norm);
    return alpha;
  }
  if (!*symmetric) {
    const double agreement = dot(rotated(mu3, alpha), *reference.mu3_direction) / norm;
    if (std::abs(agreement) >= kMinAgreement && std::abs(agreement) * asymmetry >= noise)
      return wrapped(agreement > 0.0 ? alpha : alpha + M_PI);
    *symmetric = true;
  }
  return nearestBranch(alpha, previous_alpha_.value_or(reference.alpha_star));
}

MomentFeatures FeatureBuilder::build(const View& view, const std::vector<double>& m) {
  MomentFeatures f;
  f.components = view.components;
  f.ambiguous = view.ambiguous;
  f.moment_names = names_;
  if (reference_) {
    f.has_reference = true;
    f.z_star_m = reference_->z_star_m;
    f.area_star = reference_->area_star;
  }
  if (!view.visible || !(m[0] > 0.0)) return f;

  visp_->update(m);
  f.target_visible = true;
  f.touches_border = view.touches_border;
  f.m = m;
  f.mu = visp_->mu();
  f.area = m[0];
  f.xg = visp_->gravity.get()[0];
  f.yg = visp_->gravity.get()[1];
  if (reference_) {
    visp_->normalise(*reference_);
    f.xn = visp_->gravity_normalised.get()[0];
    f.yn = visp_->gravity_normalised.get()[1];
    f.an = visp_->area.get()[0];
  }

  const double mu20 = f.mu[momentIndex(2, 0)], mu11 = f.mu[momentIndex(1, 1)], mu02 = f.mu[momentIndex(0, 2)];
  const double spread = mu20 + mu02;
  f.symmetric = true;
  if (!(spread > 0.0)) return f;  // a single pixel
  const ThirdMoments mu3 = thirdOf(f.mu);
  f.orientation_condition = std::min(std::hypot(mu20 - mu02, 2.0 * mu11) / spread, 1.0);
  f.asymmetry = std::sqrt(dot(mu3, mu3) * f.area) / std::pow(spread, 1.5);
  f.symmetric = !(f.asymmetry >= asymmetry_threshold_);
  if (!(f.orientation_condition >= orientation_threshold_)) return f;
  const double alpha = 0.5 * std::atan2(2.0 * mu11, mu20 - mu02);
  f.alpha = alpha <= -0.5 * M_PI ? alpha + M_PI : alpha;
  if (reference_) {
    const double noise = view.hard_area_px > 0 ? kStairs / std::pow(view.hard_area_px, 0.75) : 0.0;
    f.alpha = resolveAlpha(f.alpha, mu3, f.asymmetry, noise, &f.symmetric);
    previous_alpha_ = f.alpha;
  }
  f.valid = !f.touches_border;
  return f;
}

void FeatureBuilder::setReference(const Reference& reference) {
  std::string faults;
  const auto require = [&faults](const char* name, double value, bool positive) {
    if (std::isfinite(value) && (!positive || value > 0.0)) return;
    faults += (faults.empty() ? "reference/" : "\nreference/") + std::string(name) + ": found " +
              std::to_string(value) + ", allowed " + (positive ? "a finite number > 0" : "a finite number");
  };
  require("z_star_m", reference.z_star_m, true);
  require("area_star", reference.area_star, true);
  require("alpha_star", reference.alpha_star, false);
  if (!faults.empty()) throw ParameterError(faults);
  reference_ = reference;
  reference_->alpha_star = wrapped(reference.alpha_star);
  previous_alpha_.reset();
}

void FeatureBuilder::setReference(double z_star_m, const MomentFeatures& features) {
  if (!features.valid) {
    const char* why = features.ambiguous              ? "several objects, and it is not clear which is the target"
                      : !features.target_visible      ? "no target in view"
                      : features.touches_border       ? "the target is cut by the image border"
                      : std::isfinite(features.alpha) ? "the points were not found"
                                                      : "the target has no orientation";
    throw DegenerateFeature("reference view: " + std::string(why) + ", allowed a valid view");
  }
  if (static_cast<int>(features.mu.size()) < momentCount(3))
    throw ShapeError("reference view: found " + std::to_string(features.mu.size()) + " moments, allowed at least 10");
  // Points need no orientation; without one there is nothing to resolve.
  const bool oriented = std::isfinite(features.alpha);
  Reference reference{z_star_m, features.area, oriented ? features.alpha : 0.0, std::nullopt,
                      features.symmetric || !oriented};
  const ThirdMoments mu3 = thirdOf(features.mu);
  const double norm = std::sqrt(dot(mu3, mu3));
  if (!reference.symmetric && norm > 0.0) reference.mu3_direction = scaled(rotated(mu3, features.alpha), 1.0 / norm);
  setReference(reference);
}

void FeatureBuilder::clearReference() {
  reference_.reset();
  previous_alpha_.reset();
}

}  // namespace aras_visual_servo_camera
