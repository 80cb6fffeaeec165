#include "aras_visual_servo_camera/matching/match_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/depth_reader.hpp"
#include "image/grey_image.hpp"
#include "matching/goal_motion.hpp"
#include "matching/keypoints.hpp"

namespace aras_visual_servo_camera {
namespace {

const char* const kNames[] = {"orb", "akaze", "sift"};

std::string lacksDepth(const Keypoints& seen, int least) {
  if (!seen.depth_fault.empty()) return seen.depth_fault;
  return "the depth image has holes: of " + std::to_string(seen.count()) + " keypoints " +
         std::to_string(seen.withDepth()) + " have a depth, needed at least " + std::to_string(least);
}

cv::Point2d normalised(const cv::Point2d& point) { return point; }
cv::Point2d normalised(const cv::Vec3d& P) { return {P[0] / P[2], P[1] / P[2]}; }

/** The motion of the goal image itself, with which all matches agree: exact, not only to rounding. */
template <class Motion>
Motion noMotion(std::size_t matches) {
  Motion motion;
  motion.inliers.resize(matches);
  std::iota(motion.inliers.begin(), motion.inliers.end(), 0);
  return motion;
}

/** Tells which matches agree with a motion. */
template <class Motion, class Point>
void writeInliers(const Motion& motion, const std::vector<Point>& here, const std::vector<Point>& there,
                  MatchFeatures* features) {
  features->inliers = static_cast<int>(motion.inliers.size());
  features->rms_px = motion.rms_px;
  for (int i : motion.inliers) {
    const cv::Point2d p = normalised(here[static_cast<std::size_t>(i)]);
    const cv::Point2d q = normalised(there[static_cast<std::size_t>(i)]);
    features->match_x.push_back(p.x);
    features->match_y.push_back(p.y);
    features->match_goal_x.push_back(q.x);
    features->match_goal_y.push_back(q.y);
  }
}

}  // namespace

struct MatchExtractor::Goal : Keypoints {
  std::int64_t stamp_ns = kNoStamp;
  double z_star_m = MatchFeatures::kNone;  // NaN: no goal
};

struct MatchExtractor::Work {
  Work(const CameraIntrinsics& camera, const MatchingConfig& config) : intrinsics(camera), finder(config) {
    if (!config.depth) return;
    map = std::make_unique<PixelMap>(camera);
    depths = std::make_unique<DepthReader>(*map, *config.depth);
  }

  CameraIntrinsics intrinsics;
  KeypointFinder finder;
  std::unique_ptr<PixelMap> map;  // of the depth reader
  std::unique_ptr<DepthReader> depths;
  GreyReader reader;
  Keypoints seen;
  Goal goal;
  LastViews<Keypoints> last_views;

  void look(const ImageView& image, const DepthView* depth);
  void adopt(const Keypoints& view, double z_m, std::int64_t stamp_ns, int least);  // as the goal
};

void MatchExtractor::Work::look(const ImageView& image, const DepthView* depth) {
  requireSize(image, intrinsics);
  finder.find(reader.read(image), intrinsics, &seen);
  seen.z.clear();
  seen.depth_fault = depths ? depths->fault(depth) : "";
  if (!depths || !seen.depth_fault.empty()) return;
  for (const cv::Point2d& p : seen.xy) seen.z.push_back(depths->at(*depth, p.x, p.y, nullptr));
}

MatchExtractor::MatchExtractor(const CameraIntrinsics& intrinsics, const MatchingConfig& config) : config_(config) {
  setIntrinsics(intrinsics);
}

MatchExtractor::~MatchExtractor() = default;

const CameraIntrinsics& MatchExtractor::intrinsics() const { return work_->intrinsics; }

void MatchExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  auto next = std::make_unique<Work>(intrinsics, config_);
  if (work_) {
    next->goal = work_->goal;
    next->reader = std::move(work_->reader);
    next->last_views = std::move(work_->last_views);
  }
  work_ = std::move(next);
  features_ = MatchFeatures();
  features_.detector = kNames[static_cast<int>(config_.detector)];
}

void MatchExtractor::clearReference() { work_->goal = Goal(); }

std::function<void()> MatchExtractor::undo() {
  return [this, goal = std::make_shared<const Goal>(work_->goal)] { work_->goal = *goal; };
}

void MatchExtractor::setReference(const ImageView& image, double z_star_m, const DepthView* depth) {
  work_->look(image, depth);
  work_->adopt(work_->seen, z_star_m, kNoStamp, config_.min_matches);
}

void MatchExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  work_->adopt(work_->last_views.at(stamp_ns), z_star_m, stamp_ns, config_.min_matches);
}

void MatchExtractor::Work::adopt(const Keypoints& view, double z_m, std::int64_t stamp_ns, int least) {
  requireDepth(z_m);
  if (view.count() < least)
    throw DegenerateFeature("matches reference: found an image with " + std::to_string(view.count()) +
                            " keypoints, allowed at least min_matches, " + std::to_string(least));
  if (depths && view.withDepth() < least) throw DegenerateFeature("matches reference: " + lacksDepth(view, least));
  goal.xy = view.xy;
  goal.z = view.z;
  goal.descriptors = view.descriptors.clone();
  goal.stamp_ns = stamp_ns;
  goal.z_star_m = depths ? view.medianDepth() : z_m;
}

const MatchFeatures& MatchExtractor::process(const ImageView& image, std::int64_t stamp_ns, const DepthView* depth) {
  Work& w = *work_;
  w.look(image, depth);
  if (stamp_ns != kNoStamp) {
    Keypoints& kept = w.last_views.add(stamp_ns);
    kept.xy = w.seen.xy;
    kept.z = w.seen.z;
    kept.depth_fault = w.seen.depth_fault;
    w.seen.descriptors.copyTo(kept.descriptors);
  }
  MatchFeatures next;
  next.detector = kNames[static_cast<int>(config_.detector)];
  next.has_reference = w.goal.count() > 0;
  next.keypoints = w.seen.count();
  next.goal_keypoints = w.goal.count();
  next.z_star_m = w.goal.z_star_m;
  next.reference_stamp_ns = w.goal.stamp_ns;
  next.depth_fault = w.seen.depth_fault;
  if (w.depths && w.seen.count() >= config_.min_matches && w.seen.withDepth() < config_.min_matches) {
    next.fault = lacksDepth(w.seen, config_.min_matches);
  } else if (w.seen.count() >= config_.min_matches) {
    for (const cv::Point2d& p : w.seen.box()) {
      next.as_goal_x.push_back(p.x);
      next.as_goal_y.push_back(p.y);
      if (w.depths) next.as_goal_z.push_back(w.seen.medianDepth());
    }
    next.target_visible = next.valid = true;
    if (next.has_reference) w.depths ? matchInSpace(&next) : match(&next);
  } else {
    next.fault = "the image has " + std::to_string(next.keypoints) + " keypoints, needed at least " +
                 std::to_string(config_.min_matches);
  }
  features_ = std::move(next);
  return features_;
}

void MatchExtractor::match(MatchFeatures* features) const {
  const Work& w = *work_;
  std::vector<cv::Point2d> here, there;
  for (const auto& [mine, goals] : w.finder.match(w.seen, w.goal)) {
    here.push_back(w.seen.xy[static_cast<std::size_t>(mine)]);
    there.push_back(w.goal.xy[static_cast<std::size_t>(goals)]);
  }
  features->matches = static_cast<int>(here.size());
  const std::optional<PlaneHomography> plane =
      w.seen == w.goal ? noMotion<PlaneHomography>(here.size())
                       : findHomography(there, here, std::sqrt(w.intrinsics.fx() * w.intrinsics.fy()), config_);
  features->target_visible = features->valid = plane.has_value();
  if (!plane) {
    features->fault = "of " + std::to_string(features->matches) + " matches fewer than " +
                      std::to_string(config_.min_matches) + " agree on where the target is";
    return;
  }
  writeInliers(*plane, here, there, features);
  cv::Point2d middle;
  for (const cv::Point2d& p : w.goal.box()) {
    const cv::Point2d q = plane->apply(p);
    features->point_x.push_back(q.x);
    features->point_y.push_back(q.y);
    middle += 0.25 * p;
  }
  middle = plane->apply(middle);
  features->xg = middle.x;
  features->yg = middle.y;
  features->homography.assign(plane->H.val, plane->H.val + 9);
}

void MatchExtractor::matchInSpace(MatchFeatures* features) const {
  const Work& w = *work_;
  std::vector<cv::Vec3d> here, there;
  for (const auto& [mine, goals] : w.finder.match(w.seen, w.goal)) {
    ++features->matches;
    const auto i = static_cast<std::size_t>(mine), k = static_cast<std::size_t>(goals);
    if (std::isnan(w.seen.z[i]) || std::isnan(w.goal.z[k])) continue;
    here.emplace_back(w.seen.z[i] * w.seen.xy[i].x, w.seen.z[i] * w.seen.xy[i].y, w.seen.z[i]);
    there.emplace_back(w.goal.z[k] * w.goal.xy[k].x, w.goal.z[k] * w.goal.xy[k].y, w.goal.z[k]);
  }
  const std::optional<RigidMotion> motion =
      w.seen == w.goal ? noMotion<RigidMotion>(here.size())
                       : findRigidMotion(there, here, std::sqrt(w.intrinsics.fx() * w.intrinsics.fy()), config_);
  std::vector<cv::Vec3d> points;
  cv::Vec3d middle;
  for (const cv::Point2d& p : w.goal.box()) {
    points.push_back(motion ? motion->apply(w.goal.z_star_m * cv::Vec3d(p.x, p.y, 1.0)) : cv::Vec3d());
    middle += 0.25 * points.back();
  }
  const bool ahead = std::all_of(points.begin(), points.end(), [](const cv::Vec3d& P) { return P[2] > 0.0; });
  features->target_visible = features->valid = motion && ahead;
  if (!features->valid) {
    features->fault = "of " + std::to_string(features->matches) + " matches, " + std::to_string(here.size()) +
                      " with a depth in both images, fewer than " + std::to_string(config_.min_matches) +
                      " agree on where the target is";
    return;
  }
  writeInliers(*motion, here, there, features);
  for (const cv::Vec3d& P : points) {
    features->point_x.push_back(P[0] / P[2]);
    features->point_y.push_back(P[1] / P[2]);
    features->point_z.push_back(P[2]);
  }
  features->xg = middle[0] / middle[2];
  features->yg = middle[1] / middle[2];
  cv::Matx33d H = motion->R;  // + t n^T / d of the plane of the four points, n = (0, 0, 1)
  for (int row = 0; row < 3; ++row) H(row, 2) += motion->t[row] / w.goal.z_star_m;
  features->homography.assign(H.val, H.val + 9);
}

}  // namespace aras_visual_servo_camera
