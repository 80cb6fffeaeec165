#include "matching/keypoints.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace aras_visual_servo_camera {
namespace {

// FAST asks for this contrast; OpenCV's default of 20 leaves few keypoints on a poster that is printed pale.
constexpr int kFastContrast = 10;
// Between two levels of ORB's pyramid; the value is OpenCV's default.
constexpr float kOrbScale = 1.2f;
// SIFT begins with the image enlarged twice. OpenCV divides the place in that image by two, but pixel 0 of it lies a
// quarter of a pixel before pixel 0 of the image. (ORB's levels are shifted likewise.)
constexpr double kSiftShift_px = -0.25;

cv::Ptr<cv::Feature2D> makeDetector(const MatchingConfig& config) {
  if (config.detector == KeypointDetector::kAkaze) return cv::AKAZE::create();
  if (config.detector == KeypointDetector::kSift) return cv::SIFT::create(config.keypoints);
  cv::Ptr<cv::ORB> orb = cv::ORB::create(config.keypoints, kOrbScale);
  orb->setFastThreshold(kFastContrast);
  return orb;
}

/** Lets glibc keep freed memory for the next image. AKAZE takes 28 MB for the pictures of its scales in each image of
 * 640 x 480; by default they come from the system as empty pages and go back there every time, which is a tenth of its
 * time. */
void keepFreedMemory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);  // the largest that glibc allows
  mallopt(M_TRIM_THRESHOLD, 256 * 1024 * 1024);
#endif
}

/** As nearestByBits, by the length of the difference. */
std::vector<NearestTwo> nearestByLength(const cv::Mat& queries, const cv::Mat& rows) {
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2).knnMatch(queries, rows, matches, 2);
  std::vector<NearestTwo> found(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i)
    if (!matches[i].empty())
      found[i] = {matches[i][0].trainIdx, matches[i][0].distance,
                  matches[i].size() > 1 ? matches[i][1].distance : std::numeric_limits<double>::infinity()};
  return found;
}

/** The rows as whole words, the rest filled with zeros. */
std::vector<std::uint64_t> wordsOf(const cv::Mat& rows, std::size_t words) {
  std::vector<std::uint64_t> result(words * static_cast<std::size_t>(rows.rows), 0);
  for (int i = 0; i < rows.rows; ++i)
    std::memcpy(&result[static_cast<std::size_t>(i) * words], rows.ptr(i), static_cast<std::size_t>(rows.cols));
  return result;
}

/** kWords: words of a row, known to the compiler for the widths that are used; 0: `words`. */
template <std::size_t kWords>
inline __attribute__((always_inline)) void search(const std::uint64_t* queries, std::size_t query_count,
                                                  const std::uint64_t* rows, std::size_t row_count, std::size_t words,
                                                  NearestTwo* found) {
  const std::size_t width = kWords > 0 ? kWords : words;
  for (std::size_t q = 0; q < query_count; ++q) {
    const std::uint64_t* query = queries + q * width;
    int first = std::numeric_limits<int>::max(), second = first, index = -1;
    for (std::size_t r = 0; r < row_count; ++r) {
      const std::uint64_t* row = rows + r * width;
      int bits = 0;
      for (std::size_t w = 0; w < width; ++w) bits += __builtin_popcountll(query[w] ^ row[w]);
      if (bits < first) {
        second = first;
        first = bits;
        index = static_cast<int>(r);
      } else if (bits < second) {
        second = bits;
      }
    }
    found[q] = {index, static_cast<double>(first),
                row_count > 1 ? static_cast<double>(second) : std::numeric_limits<double>::infinity()};
  }
}

// Every machine gives the same numbers; those with the instruction give them sooner.
#if defined(__x86_64__)
__attribute__((target_clones("popcnt", "default")))
#endif
void searchAll(const std::uint64_t* queries, std::size_t query_count, const std::uint64_t* rows, std::size_t row_count,
               std::size_t words, NearestTwo* found) {
  if (words == 4) return search<4>(queries, query_count, rows, row_count, words, found);  // ORB
  if (words == 8) return search<8>(queries, query_count, rows, row_count, words, found);  // AKAZE
  search<0>(queries, query_count, rows, row_count, words, found);
}

}  // namespace

std::vector<NearestTwo> nearestByBits(const cv::Mat& queries, const cv::Mat& rows) {
  const std::size_t words = (static_cast<std::size_t>(rows.cols) + 7) / 8;
  std::vector<NearestTwo> found(static_cast<std::size_t>(queries.rows));
  const std::vector<std::uint64_t> a = wordsOf(queries, words), b = wordsOf(rows, words);
  if (!a.empty() && !b.empty())
    searchAll(a.data(), found.size(), b.data(), static_cast<std::size_t>(rows.rows), words, found.data());
  return found;
}

bool Keypoints::operator==(const Keypoints& other) const {
  return xy == other.xy && descriptors.size() == other.descriptors.size() &&
         descriptors.type() == other.descriptors.type() &&
         std::memcmp(descriptors.data, other.descriptors.data, descriptors.total() * descriptors.elemSize()) == 0;
}

int Keypoints::withDepth() const {
  return static_cast<int>(std::count_if(z.begin(), z.end(), [](double one) { return !std::isnan(one); }));
}

double Keypoints::medianDepth() const {
  std::vector<double> known;
  std::copy_if(z.begin(), z.end(), std::back_inserter(known), [](double one) { return !std::isnan(one); });
  if (known.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

std::array<cv::Point2d, 4> Keypoints::box() const {
  const cv::Point2d middle = std::accumulate(xy.begin(), xy.end(), cv::Point2d()) / static_cast<double>(count());
  cv::Point2d squares;
  for (const cv::Point2d& p : xy) squares += {(p.x - middle.x) * (p.x - middle.x), (p.y - middle.y) * (p.y - middle.y)};
  const double dx = std::sqrt(squares.x / count()), dy = std::sqrt(squares.y / count());
  return {{{middle.x - dx, middle.y - dy},
           {middle.x + dx, middle.y - dy},
           {middle.x + dx, middle.y + dy},
           {middle.x - dx, middle.y + dy}}};
}

KeypointFinder::KeypointFinder(const MatchingConfig& config)
    : name_(config.detector),
      detector_(makeDetector(config)),
      norm_(config.detector == KeypointDetector::kSift ? cv::NORM_L2 : cv::NORM_HAMMING),
      most_(config.keypoints),
      ratio_(config.ratio) {
  cv::setNumThreads(1);
  keepFreedMemory();
}

double KeypointFinder::shiftOf(const cv::KeyPoint& keypoint) const {
  if (name_ == KeypointDetector::kSift) return kSiftShift_px;
  if (name_ == KeypointDetector::kOrb) return 0.5 * (std::pow(kOrbScale, keypoint.octave) - 1.0);
  return 0.0;
}

void KeypointFinder::find(const cv::Mat& grey, const CameraIntrinsics& intrinsics, Keypoints* found) const {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  detector_->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  std::vector<int> chosen(keypoints.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  if (static_cast<int>(chosen.size()) > most_) {
    std::stable_sort(chosen.begin(), chosen.end(),
                     [&](int a, int b) { return keypoints[a].response > keypoints[b].response; });
    chosen.resize(static_cast<std::size_t>(most_));
    std::sort(chosen.begin(), chosen.end());
  }
  found->xy.clear();
  std::vector<int> rows;
  for (int k : chosen) {
    const double shift_px = shiftOf(keypoints[k]);
    const auto ray = intrinsics.undistort(keypoints[k].pt.x + shift_px, keypoints[k].pt.y + shift_px);
    if (!ray.valid) continue;
    found->xy.emplace_back(ray.x, ray.y);
    rows.push_back(k);
  }
  found->descriptors.create(static_cast<int>(rows.size()), descriptors.cols, descriptors.type());
  for (std::size_t i = 0; i < rows.size(); ++i)
    descriptors.row(rows[i]).copyTo(found->descriptors.row(static_cast<int>(i)));
}

std::vector<std::array<int, 2>> KeypointFinder::match(const Keypoints& image, const Keypoints& goal) const {
  std::vector<std::array<int, 2>> pairs;
  if (image.count() == 0 || goal.count() == 0) return pairs;
  const std::vector<NearestTwo> nearest = norm_ == cv::NORM_HAMMING
                                              ? nearestByBits(image.descriptors, goal.descriptors)
                                              : nearestByLength(image.descriptors, goal.descriptors);
  std::vector<int> best(goal.xy.size(), -1);  // of each keypoint of the goal the nearest of the image
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (!(nearest[i].first < ratio_ * nearest[i].second)) continue;
    int& so_far = best[static_cast<std::size_t>(nearest[i].index)];
    if (so_far < 0 || nearest[i].first < nearest[static_cast<std::size_t>(so_far)].first) so_far = static_cast<int>(i);
  }
  for (std::size_t k = 0; k < best.size(); ++k)
    if (best[k] >= 0) pairs.push_back({best[k], static_cast<int>(k)});
  return pairs;
}

}  // namespace aras_visual_servo_camera
