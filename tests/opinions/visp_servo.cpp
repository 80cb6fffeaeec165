// What ViSP's own vpServo makes of given cases: a second opinion on the laws of the controller.
//
// Reads a YAML (or JSON) list of cases from standard input, writes a JSON list with one object per case:
//   {"twist": V_C [v; w], "error": s - s*, "matrix": the rows that vpServo inverted}
// Keys of every case: kind, gain_per_s, and interaction (desired, current or mean). Those of each kind are named at the
// function that answers it. test_visp_servo.py asks, and names the places where ViSP 3.5 itself is wrong.
#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpHomogeneousMatrix.h>
#include <visp3/core/vpImage.h>
#include <visp3/core/vpMomentAlpha.h>
#include <visp3/core/vpMomentCommon.h>
#include <visp3/core/vpMomentObject.h>
#include <visp3/core/vpPoint.h>
#include <visp3/visual_features/vpFeatureDepth.h>
#include <visp3/visual_features/vpFeatureEllipse.h>
#include <visp3/visual_features/vpFeatureLuminance.h>
#include <visp3/visual_features/vpFeatureMomentCommon.h>
#include <visp3/visual_features/vpFeaturePoint.h>
#include <visp3/visual_features/vpFeatureThetaU.h>
#include <visp3/visual_features/vpFeatureTranslation.h>
#include <visp3/visual_features/vpGenericFeature.h>
#include <visp3/vs/vpServo.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <iterator>
#include <list>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using Numbers = std::vector<double>;

Numbers numbers(const YAML::Node& c, const char* key) { return c[key].as<Numbers>(); }

vpServo::vpServoIteractionMatrixType interactionOf(const YAML::Node& c) {
  const std::map<std::string, vpServo::vpServoIteractionMatrixType> known{
      {"desired", vpServo::DESIRED}, {"current", vpServo::CURRENT}, {"mean", vpServo::MEAN}};
  return known.at(c["interaction"].as<std::string>());
}

void prepare(vpServo& task, const YAML::Node& c) {
  task.setServo(vpServo::EYEINHAND_CAMERA);
  task.setInteractionMatrixType(interactionOf(c), vpServo::PSEUDO_INVERSE);
  const double gain = c["gain_per_s"].as<double>();
  if (c["adaptive"]) {  // [infinity_part, slope]: ViSP wants gains and their slope
    const Numbers a = numbers(c, "adaptive");
    task.setLambda(gain, a[0] * gain, a[1] * gain);
  } else {
    task.setLambda(gain);
  }
}

void print(const char* name, const vpArray2D<double>& values, const char* after) {
  std::printf("\"%s\": [", name);
  for (unsigned int i = 0; i < values.size(); ++i) std::printf("%s%.17g", i ? ", " : "", values.data[i]);
  std::printf("]%s", after);
}

void answer(vpServo& task) {
  const vpColVector twist = task.computeControlLaw();
  std::printf("{");
  print("twist", twist, ", ");
  print("error", task.getError(), ", ");
  print("matrix", task.getInteractionMatrix(), "}");
}

vpHomogeneousMatrix pose(const YAML::Node& c, const char* key) {
  vpHomogeneousMatrix X;
  const Numbers values = numbers(c, key);
  for (unsigned int k = 0; k < 12; ++k) X[k / 4][k % 4] = values.at(k);
  return X;
}

// points, points_star: x, y, Z of one point after the other.
void points(vpServo& task, const YAML::Node& c) {
  const Numbers here = numbers(c, "points"), goal = numbers(c, "points_star");
  std::list<vpFeaturePoint> kept;  // vpServo keeps pointers
  const auto keep = [&kept](const double* p) -> vpFeaturePoint& {
    kept.emplace_back();
    kept.back().buildFrom(p[0], p[1], p[2]);
    return kept.back();
  };
  for (std::size_t k = 0; k + 2 < here.size(); k += 3) {
    vpFeaturePoint &s = keep(&here[k]), &s_star = keep(&goal[k]);
    task.addFeature(s, s_star);
  }
  answer(task);
}

// X_CgC: the camera in the frame of the goal, row by row. cdMc and cdRc are ViSP's names for it.
void pbvs(vpServo& task, const YAML::Node& c) {
  vpHomogeneousMatrix X_CgC = pose(c, "X_CgC");
  vpFeatureTranslation t(vpFeatureTranslation::cdMc), t_star(vpFeatureTranslation::cdMc);
  vpFeatureThetaU theta_u(vpFeatureThetaU::cdRc), theta_u_star(vpFeatureThetaU::cdRc);
  t.buildFrom(X_CgC);
  theta_u.buildFrom(X_CgC);
  task.addFeature(t, t_star);
  task.addFeature(theta_u, theta_u_star);
  answer(task);
}

// X_CgC as above, point and point_star: x, y, Z of the reference point.
void hybrid(vpServo& task, const YAML::Node& c) {
  const Numbers here = numbers(c, "point"), goal = numbers(c, "point_star");
  vpFeaturePoint s, s_star;
  s.buildFrom(here[0], here[1], here[2]);
  s_star.buildFrom(goal[0], goal[1], goal[2]);
  vpFeatureDepth depth, depth_star;
  depth.buildFrom(here[0], here[1], here[2], std::log(here[2] / goal[2]));
  depth_star.buildFrom(goal[0], goal[1], goal[2], 0.0);
  vpFeatureThetaU theta_u(vpFeatureThetaU::cdRc), theta_u_star(vpFeatureThetaU::cdRc);
  theta_u.buildFrom(pose(c, "X_CgC"));
  task.addFeature(s, s_star);
  task.addFeature(depth, depth_star);
  task.addFeature(theta_u, theta_u_star);
  answer(task);
}

// A polygon in the image as ViSP wants it: closed, and clockwise on the screen (y down), or m00 is negative. Order 6:
// vpMomentCommon asks for 5, with which rows of the invariants of order 5 are wrong.
vpMomentObject momentsOf(const Numbers& outline) {
  const std::size_t count = outline.size() / 2;
  double twice_area = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    twice_area += outline[2 * k] * outline[2 * next + 1] - outline[2 * next] * outline[2 * k + 1];
  }
  std::vector<vpPoint> corners;
  for (std::size_t k = 0; k <= count; ++k) {
    const std::size_t at = twice_area < 0.0 ? count - 1 - k % count : k % count;
    vpPoint p;
    p.set_x(outline[2 * at]);
    p.set_y(outline[2 * at + 1]);
    corners.push_back(p);
  }
  vpMomentObject object(6);
  object.setType(vpMomentObject::DENSE_POLYGON);
  object.fromVector(corners);
  return object;
}

// ViSP's moment features of one view.
class MomentView {
 public:
  MomentView(const YAML::Node& c, const char* outline, const char* plane)
      : goal_(momentsOf(numbers(c, "outline_star"))),
        object_(momentsOf(numbers(c, outline))),
        // Z* must be given: it is 1 if left out, and scales xn, yn and an.
        moments_(vpMomentCommon::getSurface(goal_), vpMomentCommon::getMu3(goal_), vpMomentCommon::getAlpha(goal_),
                 c["z_star_m"].as<double>()),
        features_(moments_) {
    moments_.updateAll(object_);
    const Numbers p = numbers(c, plane);
    features_.updateAll(p[0], p[1], p[2]);
    const unsigned int all = vpBasicFeature::FEATURE_ALL;
    list_ = {{&features_.getFeatureGravityNormalized(), all}, {&features_.getFeatureAn(), all}};
    if (c["tilt"].as<bool>())
      for (const unsigned int one : {vpFeatureMomentCInvariant::selectSx(), vpFeatureMomentCInvariant::selectSy()})
        list_.emplace_back(&features_.getFeatureCInvariant(), one);
    list_.emplace_back(&features_.getFeatureAlpha(), all);
  }

  std::vector<std::pair<vpBasicFeature*, unsigned int>>& list() { return list_; }

  // All of them as one feature, `off` added to the entry of xn and vx.
  vpGenericFeature mended(double off) {
    vpColVector s;
    vpMatrix L;
    for (auto [feature, select] : list_) {
      s.stack(feature->get_s(select));
      L.stack(feature->interaction(select));
    }
    L[0][0] += off;
    vpGenericFeature all(s.size());
    all.set_s(s);
    all.setInteractionMatrix(L);
    return all;
  }

 private:
  vpMomentObject goal_, object_;
  vpMomentCommon moments_;
  vpFeatureMomentCommon features_;
  std::vector<std::pair<vpBasicFeature*, unsigned int>> list_;
};

// outline, outline_star: x, y of the corners in the image. plane, plane_star: (A, B, C) of 1/Z. z_star_m. tilt: sx and
// sy are features too, or wx and wy are left alone. mend_by: added to ViSP's entry of xn and vx in the current view.
void moments(vpServo& task, const YAML::Node& c) {
  MomentView here(c, "outline", "plane"), goal(c, "outline_star", "plane_star");
  if (!c["tilt"].as<bool>()) {
    vpColVector free_axes(6, 1.0);
    free_axes[3] = free_axes[4] = 0.0;
    task.setCameraDoF(free_axes);
  }
  if (c["mend_by"]) {
    vpGenericFeature s = here.mended(c["mend_by"].as<double>()), s_star = goal.mended(0.0);
    task.addFeature(s, s_star);
    answer(task);
    return;
  }
  for (std::size_t k = 0; k < here.list().size(); ++k)
    task.addFeature(*here.list()[k].first, *goal.list()[k].first, here.list()[k].second);
  answer(task);
}

// ellipse, ellipse_star: x, y, n20, n11, n02. plane, plane_star: (A, B, C) of 1/Z on the circle, or on the rim of a
// sphere.
void ellipse(vpServo& task, const YAML::Node& c) {
  vpFeatureEllipse s, s_star;
  for (auto [feature, seen, plane] :
       {std::tuple(&s, "ellipse", "plane"), std::tuple(&s_star, "ellipse_star", "plane_star")}) {
    const Numbers e = numbers(c, seen), p = numbers(c, plane);
    feature->buildFrom(e.at(0), e.at(1), e.at(2), e.at(3), e.at(4));
    feature->setABC(p.at(0), p.at(1), p.at(2));
  }
  task.addFeature(s, s_star);
  answer(task);
}

vpImage<unsigned char> image(const YAML::Node& c, const char* key) {
  const auto width = c["width"].as<unsigned int>(), height = c["height"].as<unsigned int>();
  const auto hex = c[key].as<std::string>();
  if (hex.size() != 2 * std::size_t(width) * height) throw std::invalid_argument(std::string(key) + ": wrong size");
  vpImage<unsigned char> result(height, width);
  for (unsigned int k = 0; k < width * height; ++k)
    result.bitmap[k] = static_cast<unsigned char>(std::stoi(hex.substr(2 * k, 2), nullptr, 16));
  return result;
}

// image, image_star: grey levels, row by row, two hexadecimal digits each. width, height, camera: fx, fy, cx, cy. z_m.
void luminance(vpServo& task, const YAML::Node& c) {
  const Numbers k = numbers(c, "camera");
  vpCameraParameters camera(k[0], k[1], k[2], k[3]);
  vpImage<unsigned char> here = image(c, "image"), goal = image(c, "image_star");
  vpFeatureLuminance s, s_star;
  for (auto [feature, seen] : {std::pair(&s, &here), std::pair(&s_star, &goal)}) {
    feature->init(here.getHeight(), here.getWidth(), c["z_m"].as<double>());
    feature->setCameraParameters(camera);
    feature->buildFrom(*seen);
  }
  task.addFeature(s, s_star);
  answer(task);
}

}  // namespace

int main() try {
  const std::map<std::string, std::function<void(vpServo&, const YAML::Node&)>> kinds{
      {"points", points},   {"pbvs", pbvs},       {"hybrid", hybrid},
      {"moments", moments}, {"ellipse", ellipse}, {"luminance", luminance}};
  const std::string text((std::istreambuf_iterator<char>(std::cin)), std::istreambuf_iterator<char>());
  const YAML::Node cases = YAML::Load(text);
  std::printf("[");
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (k > 0) std::printf(",\n");
    vpServo task;
    prepare(task, cases[k]);
    kinds.at(cases[k]["kind"].as<std::string>())(task, cases[k]);
    task.kill();
  }
  std::printf("]\n");
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "visp_servo: %s\n", error.what());
  return 1;
}
