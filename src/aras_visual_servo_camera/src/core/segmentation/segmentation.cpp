#include "aras_visual_servo_camera/segmentation/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/grey_image.hpp"
#include "moments/shape.hpp"
#include "segmentation/colour_channel.hpp"
#include "segmentation/components.hpp"
#include "segmentation/edge_weights.hpp"
#include "segmentation/object_selector.hpp"

namespace aras_visual_servo_camera {
namespace {

// An edge pixel of the first or last row or column that is covered by more than this means that the object goes on
// outside the image.
constexpr double kBorderWeight = 0.1;

}  // namespace

/** Pixels without a usable ray, such as those that a fisheye sees beyond CameraIntrinsics::kWidestAngle and those
 *  outside its circle. The segmentation treats them as lying outside the image. */
class BlindArea {
 public:
  BlindArea() = default;
  explicit BlindArea(const PixelMap& map) {
    if (map.separable()) return;
    blind_ = cv::Mat::zeros(map.height(), map.width(), CV_8UC1);
    for (int v = 0; v < map.height(); ++v)
      for (int u = 0; u < map.width(); ++u)
        if (!map.sees(u, v)) blind_.at<std::uint8_t>(v, u) = 255;
    count_ = cv::countNonZero(blind_);
    constexpr int kReach = 3;  // [px]: an edge is two wide
    cv::dilate(blind_, near_, cv::Mat::ones(2 * kReach + 1, 2 * kReach + 1, CV_8UC1));
  }

  /** Number of such pixels. */
  int count() const { return count_; }
  /** 255 where there is such a pixel, else 0; empty: there is none. */
  const cv::Mat& pixels() const { return blind_; }
  /** Whether a component comes so near to these pixels that its edge may lie among them. */
  bool meets(const std::vector<Run>& runs, int component) const {
    return count_ > 0 && std::any_of(runs.begin(), runs.end(), [&](const Run& run) {
             if (run.component != component) return false;
             const std::uint8_t* row = near_.ptr(run.v);
             return std::find(row + run.u_begin, row + run.u_end, 255) != row + run.u_end;
           });
  }

 private:
  int count_ = 0;
  cv::Mat blind_, near_;  // 255 where it is so
};

namespace {

/** Pixels with (grey ^ flip) <= level are in the object. */
struct Threshold {
  std::uint8_t flip, level;
};

// Dark: grey < threshold; bright: grey > threshold.
std::optional<Threshold> strictThreshold(bool dark, double threshold) {
  const double level = dark ? std::ceil(threshold) - 1.0 : 254.0 - std::floor(threshold);
  if (level < 0.0) return std::nullopt;
  return Threshold{static_cast<std::uint8_t>(dark ? 0 : 255), static_cast<std::uint8_t>(std::min(level, 255.0))};
}

}  // namespace

struct Segmentation::Work {
  VisionConfig config;
  bool dark = true;                      // the object is, in the image that is segmented
  std::optional<ColourChannel> channel;  // of an object that is a colour
  GreyReader reader;
  cv::Mat seeing, mean, binary;
  int fill_grey = 0, filled = 0;  // grey and number of the pixels that are not of the image
  double min_contrast = 0.0;      // of the image that is segmented
  BlindArea blind;
  ComponentFinder finder;
  EdgeWeights edge_weights;
  ObjectMask mask;
  std::vector<ObjectMask> objects;
  ObjectSelector selector{VisionConfig()};  // until the constructor sets it
  std::optional<ShapeSignature> reference_shape;
  std::vector<Candidate> candidates;
  std::vector<int> component_of;  // of each candidate
  bool was_cut = false;           // the object was cut by the border and has not been clear of it since

  /** The image that is segmented, its blind pixels set to the grey that is farthest from the object's. Of an object
   * that is a colour it is the channel's. Empty: no pixel has the colour. */
  cv::Mat greyIn(const ImageView& image);
  std::array<int, 256> histogramOf(const cv::Mat& grey) const;
  std::optional<GreyLevels> levelsOf(const cv::Mat& grey) const;
  std::optional<Threshold> thresholdOf(const cv::Mat& grey) const;
  void makeAdaptiveBinary(const cv::Mat& grey);
  void listCandidates(const cv::Mat& grey, const std::optional<GreyLevels>& levels);
  double dissimilarityOf(const cv::Mat& grey, const std::optional<GreyLevels>& levels, int component);
  /** Weights and description of one component; `out` has the size of the image and nothing else. */
  void extract(const cv::Mat& grey, const std::optional<GreyLevels>& levels, int component, ObjectMask* out);
  void extractAll(const cv::Mat& grey, const std::optional<GreyLevels>& levels);
  /** Whether a component has a pixel in the rim of the image that is so wide. */
  bool isNearBorder(const Component& c, int margin_px) const;
  ObjectMask emptyMask() const;
  void applyBorderMargin(int component);
};

Segmentation::Segmentation(const VisionConfig& config) : work_(std::make_unique<Work>()) {
  work_->config = config;
  work_->dark = isDark(config);
  work_->min_contrast = config.min_contrast;
  if (const auto* colour = std::get_if<ObjectColour>(&config.object))
    work_->channel.emplace(*colour, config.min_contrast);
  work_->selector = ObjectSelector(config);
}
Segmentation::~Segmentation() = default;

void Segmentation::setMap(const PixelMap& map) { work_->blind = BlindArea(map); }

void Segmentation::forgetPrevious() {
  work_->selector.forget();
  work_->was_cut = false;
}

void Segmentation::setReferenceShape(double m00, const std::vector<double>& mu) {
  work_->reference_shape = shapeOf(m00, mu);
}

void Segmentation::clearReferenceShape() { work_->reference_shape.reset(); }

int Segmentation::white() const { return work_->reader.white(); }

const std::vector<ObjectMask>& Segmentation::objects() const { return work_->objects; }

cv::Mat Segmentation::Work::greyIn(const ImageView& image) {
  if (channel) {
    if (!channel->process(reader.readRgb(image), blind.pixels())) return cv::Mat();
    fill_grey = channel->backgroundGrey();
    filled = channel->leftOut();
    min_contrast = config.min_contrast * channel->gain();
    return channel->grey();
  }
  const cv::Mat grey = reader.read(image);
  fill_grey = dark ? 255 : 0;
  filled = blind.count();
  if (filled == 0) return grey;
  grey.copyTo(seeing);
  seeing.setTo(fill_grey, blind.pixels());
  return seeing;
}

std::array<int, 256> Segmentation::Work::histogramOf(const cv::Mat& grey) const {
  std::array<int, 256> histogram = countGreys(grey.ptr(), grey.cols, grey.rows, grey.step);
  histogram[fill_grey] -= filled;
  return histogram;
}

std::optional<GreyLevels> Segmentation::Work::levelsOf(const cv::Mat& grey) const {
  if (config.object_grey && config.background_grey) return GreyLevels{*config.object_grey, *config.background_grey};
  const ObjectShade shade = dark ? ObjectShade::kDark : ObjectShade::kBright;
  std::optional<GreyLevels> levels = estimateGreyLevels(histogramOf(grey), shade, config.min_area_px, min_contrast);
  if (!levels) return std::nullopt;
  levels->object_estimated = !config.object_grey;
  levels->background_estimated = !config.background_grey;
  if (config.object_grey) levels->object = *config.object_grey;
  if (config.background_grey) levels->background = *config.background_grey;
  const double contrast = levels->background - levels->object;
  if ((dark ? contrast : -contrast) < min_contrast) return std::nullopt;
  return levels;
}

std::optional<Threshold> Segmentation::Work::thresholdOf(const cv::Mat& grey) const {
  if (config.segmentation == SegmentationMethod::kFixed) return strictThreshold(dark, config.threshold.value());
  const std::array<int, 256> histogram = histogramOf(grey);
  const std::optional<int> split = otsuThreshold(histogram);
  if (!split) return std::nullopt;
  double n[2] = {0.0, 0.0}, sum[2] = {0.0, 0.0};
  for (int g = 0; g < 256; ++g) {
    n[g > *split] += histogram[g];
    sum[g > *split] += static_cast<double>(histogram[g]) * g;
  }
  if (sum[1] / n[1] - sum[0] / n[0] < min_contrast) return std::nullopt;
  return strictThreshold(dark, *split + 0.5);
}

void Segmentation::Work::makeAdaptiveBinary(const cv::Mat& grey) {
  cv::boxFilter(grey, mean, CV_32F, cv::Size(config.adaptive_block_px, config.adaptive_block_px), cv::Point(-1, -1),
                true, cv::BORDER_REPLICATE);
  binary.create(grey.rows, grey.cols, CV_8UC1);
  const float sign = dark ? -1.0f : 1.0f;
  const float offset = static_cast<float>(config.adaptive_offset);
  for (int v = 0; v < grey.rows; ++v) {
    const std::uint8_t* g = grey.ptr(v);
    const float* local = mean.ptr<float>(v);
    std::uint8_t* out = binary.ptr(v);
    for (int u = 0; u < grey.cols; ++u) out[u] = sign * (static_cast<float>(g[u]) - local[u]) > offset ? 0 : 255;
  }
}

void Segmentation::Work::listCandidates(const cv::Mat& grey, const std::optional<GreyLevels>& levels) {
  candidates.clear();
  component_of.clear();
  const int least = config.lost_area_px.value_or(config.min_area_px);
  for (std::size_t k = 0; k < finder.components().size(); ++k) {
    const Component& c = finder.components()[k];
    if (c.area_px < least) continue;
    const double n = static_cast<double>(c.area_px);
    const bool cut = isNearBorder(c, 1) || blind.meets(finder.runs(), static_cast<int>(k));
    candidates.push_back({static_cast<double>(c.sum_u) / n, static_cast<double>(c.sum_v) / n, n, c.u_min, c.u_max,
                          c.v_min, c.v_max, cut, c.area_px < config.min_area_px,
                          dissimilarityOf(grey, levels, static_cast<int>(k))});
    component_of.push_back(static_cast<int>(k));
  }
}

double Segmentation::Work::dissimilarityOf(const cv::Mat& grey, const std::optional<GreyLevels>& levels,
                                           int component) {
  if (config.component != ComponentChoice::kMostSimilar || !reference_shape)
    return std::numeric_limits<double>::quiet_NaN();
  ObjectMask object = emptyMask();
  extract(grey, levels, component, &object);
  const std::optional<ShapeSignature> shape = shapeOf(object);
  return shape ? dissimilarity(*shape, *reference_shape) : std::numeric_limits<double>::infinity();
}

void Segmentation::Work::extract(const cv::Mat& grey, const std::optional<GreyLevels>& levels, int component,
                                 ObjectMask* out) {
  if (levels) {
    edge_weights.process(grey.ptr(), grey.step, grey.cols, grey.rows, finder, component, *levels, out);
  } else {
    for (const Run& run : finder.runs())
      if (run.component == component) out->spans.emplace_back() = {run.v, run.u_begin, run.u_end};
  }
  const Component& c = finder.components()[component];
  const int u_last = out->width_px - 1, v_last = out->height_px - 1;
  out->visible = true;
  out->area_px = static_cast<int>(c.area_px);
  out->u_px = static_cast<double>(c.sum_u) / static_cast<double>(c.area_px);
  out->v_px = static_cast<double>(c.sum_v) / static_cast<double>(c.area_px);
  out->touches_border = isNearBorder(c, 1) || blind.meets(finder.runs(), component);
  for (const EdgePixel& e : out->edge)
    if (e.weight > kBorderWeight && (e.u == 0 || e.v == 0 || e.u == u_last || e.v == v_last))
      out->touches_border = true;
}

void Segmentation::Work::extractAll(const cv::Mat& grey, const std::optional<GreyLevels>& levels) {
  for (std::size_t k = 0; k < finder.components().size(); ++k) {
    if (finder.components()[k].area_px < config.min_area_px) continue;
    ObjectMask object = emptyMask();
    object.components = mask.components;
    extract(grey, levels, static_cast<int>(k), &object);
    objects.push_back(std::move(object));
  }
}

bool Segmentation::Work::isNearBorder(const Component& c, int margin_px) const {
  return c.u_min < margin_px || c.v_min < margin_px || c.u_max >= mask.width_px - margin_px ||
         c.v_max >= mask.height_px - margin_px;
}

ObjectMask Segmentation::Work::emptyMask() const {
  ObjectMask empty;
  empty.width_px = mask.width_px;
  empty.height_px = mask.height_px;
  empty.soft_edges = mask.soft_edges;
  return empty;
}

void Segmentation::Work::applyBorderMargin(int component) {
  was_cut = mask.touches_border || (was_cut && isNearBorder(finder.components()[component], config.border_margin_px));
  mask.touches_border = was_cut;
}

const ObjectMask& Segmentation::process(const ImageView& image) {
  Work& w = *work_;
  const cv::Mat grey = w.greyIn(image);
  const bool soft = w.config.segmentation == SegmentationMethod::kCoverage;
  ObjectMask empty;
  empty.width_px = image.width_px;
  empty.height_px = image.height_px;
  empty.soft_edges = soft;
  empty.spans.swap(w.mask.spans);
  empty.edge.swap(w.mask.edge);
  empty.spans.clear();
  empty.edge.clear();
  w.mask = std::move(empty);
  w.objects.clear();
  if (grey.empty()) return w.mask;

  cv::Mat scanned = grey;
  std::optional<GreyLevels> levels;
  std::optional<Threshold> threshold;
  if (w.config.segmentation == SegmentationMethod::kAdaptive) {
    w.makeAdaptiveBinary(grey);
    scanned = w.binary;
    threshold = Threshold{0, 0};
  } else if (soft) {
    levels = w.levelsOf(grey);
    if (levels) threshold = strictThreshold(w.dark, 0.5 * (levels->object + levels->background));
  } else if (w.channel && w.config.segmentation == SegmentationMethod::kFixed) {
    scanned = w.channel->members();
    threshold = Threshold{255, 0};
  } else {
    threshold = w.thresholdOf(grey);
  }
  if (!threshold) return w.mask;

  w.finder.process(scanned.ptr(), scanned.step, scanned.cols, scanned.rows, threshold->flip, threshold->level);
  for (const Component& c : w.finder.components()) w.mask.components += c.area_px >= w.config.min_area_px;
  if (w.config.points == PointSource::kBlobs) {  // several objects are the target: there is none to choose
    w.extractAll(grey, levels);
    return w.mask;
  }
  w.listCandidates(grey, levels);
  const ObjectSelector::Choice choice = w.selector.choose(w.candidates);
  w.mask.ambiguous = choice.ambiguous;
  if (choice.index < 0) return w.mask;
  w.extract(grey, levels, w.component_of[choice.index], &w.mask);
  w.applyBorderMargin(w.component_of[choice.index]);
  return w.mask;
}

}  // namespace aras_visual_servo_camera
