#include "camera_node.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <aras_visual_servo_common/ros/yaml_from_xmlrpc.hpp>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/overlay.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr int kQueue = 100;                    // images that may wait: none is dropped in normal running
constexpr std::uint32_t kFeatureQueue = 1000;  // messages: a listener that hesitates for seconds loses nothing
constexpr std::chrono::seconds kThrottlePeriod{10};
constexpr std::size_t kKeptDepths = 32;  // depth images whose images have not come
constexpr double kDepthPeriod_s = 0.05;  // wall time between looks at images that wait for depth
constexpr double kReportPeriod_s = 2.0;  // wall time without a pair after which the cause is reported

sensor_msgs::Image emptyImage(const std_msgs::Header& header, const ImageView& view, const std::string& encoding,
                              int bytes_per_pixel) {
  sensor_msgs::Image image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(view.width_px);
  image.height = static_cast<std::uint32_t>(view.height_px);
  image.encoding = encoding;
  image.step = image.width * static_cast<std::uint32_t>(bytes_per_pixel);
  return image;
}

/** The vision section: `~vision`, else `~scenario/vision`, else `scenario/vision` of the namespace. */
VisionConfig readParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue value;
  if (private_node.getParam("vision", value) || private_node.getParam("scenario/vision", value) ||
      node.getParam("scenario/vision", value))
    return readVisionConfig(aras_visual_servo_common::yamlFromXmlRpc(value));
  throw ParameterError("vision: found nothing, allowed a mapping in " + private_node.resolveName("vision") + ", " +
                       private_node.resolveName("scenario/vision") + " or " + node.resolveName("scenario/vision"));
}

/** Publishes the features of an extractor, if there is one. */
template <typename Extractor>
void publishFeatures(const std::unique_ptr<Extractor>& extractor, const std_msgs::Header& header, double age_s,
                     const ros::Publisher& publisher) {
  if (!extractor) return;
  auto message = toMessage(extractor->features());
  message.header = header;
  message.age_s = age_s;
  publisher.publish(message);
}

std::int64_t nanoseconds(const ros::Time& stamp) { return static_cast<std::int64_t>(stamp.toNSec()); }

}  // namespace

void Throttle::error(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (text == last_text_ && now - last_ < kThrottlePeriod) return;
  last_text_ = text;
  last_ = now;
  ROS_ERROR_STREAM("camera_node: " << text);
}

std::deque<DepthPairing::Image>::const_iterator DepthPairing::depthOf(const Waiting& waiting) const {
  return std::find_if(depths_.begin(), depths_.end(),
                      [&](const Image& depth) { return depth->header.stamp == waiting.image->header.stamp; });
}

bool DepthPairing::isOverdue(Clock::time_point now) const {
  return !coming_ || now - waiting_.front().since > kPatience ||
         std::any_of(waiting_.begin() + 1, waiting_.end(),
                     [&](const Waiting& later) { return depthOf(later) != depths_.end(); });
}

void DepthPairing::addImage(const Image& image, const Info& info, Clock::time_point now) {
  waiting_.push_back({image, info, now});
  look(now);
}

void DepthPairing::addDepth(const Image& depth, Clock::time_point now) {
  coming_ = true;
  if (!depths_.empty() && depth->header.stamp < depths_.back()->header.stamp) depths_.clear();  // time went back
  if (depths_.size() == kKeptDepths) depths_.pop_front();
  depths_.push_back(depth);
  look(now);
}

void DepthPairing::look(Clock::time_point now) {
  while (!waiting_.empty()) {
    const auto found = depthOf(waiting_.front());
    Image depth;
    if (found != depths_.end()) {
      depth = *found;
      depths_.erase(depths_.begin(), found + 1);
    } else if (!isOverdue(now)) {
      return;
    } else if (now - waiting_.front().since > kPatience) {
      coming_ = false;
    }
    const Waiting first = waiting_.front();
    waiting_.pop_front();
    hand_on_(first.image, first.info, depth);
  }
}

CameraNode::CameraNode(ros::NodeHandle node, const ros::NodeHandle& private_node)
    : config_(readParameters(node, private_node)), synchronizer_(kQueue) {
  features_pub_ = node.advertise<aras_visual_servo_msgs::MomentFeatures>("camera/features", kFeatureQueue);
  if (config_.photometric)
    photometric_pub_ = node.advertise<aras_visual_servo_msgs::PhotometricFeatures>("camera/photometric", kQueue);
  if (config_.tag) tag_pub_ = node.advertise<aras_visual_servo_msgs::TagFeatures>("camera/tag", kFeatureQueue);
  if (config_.matches)
    matches_pub_ = node.advertise<aras_visual_servo_msgs::MatchFeatures>("camera/matches", kFeatureQueue);
  converted_pub_ = node.advertise<Image>("camera/converted_image", kQueue);
  overlay_pub_ = node.advertise<Image>("camera/overlay", kQueue);
  reference_service_ = node.advertiseService("camera/set_reference", &CameraNode::onSetReference, this);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  info_sub_.subscribe(node, "camera/camera_info", kQueue, hints);
  image_sub_.subscribe(node, "camera/image_raw", kQueue, hints);
  if (config_.depth || (config_.matches && config_.matches->depth)) {
    depths_ = std::make_unique<DepthPairing>(
        [this](const auto& image, const auto& info, const auto& depth) { process(image, info, depth); });
    depth_sub_ = node.subscribe<Image>(
        "camera/depth/image_raw", kQueue,
        [this](const sensor_msgs::ImageConstPtr& depth) { depths_->addDepth(depth, DepthPairing::Clock::now()); },
        ros::VoidConstPtr(), hints);
    depth_timer_ = node.createWallTimer(ros::WallDuration(kDepthPeriod_s), [this](const ros::WallTimerEvent&) {
      depths_->look(DepthPairing::Clock::now());
    });
  }
  synchronizer_.connectInput(image_sub_, info_sub_);
  synchronizer_.registerCallback(&CameraNode::onPair, this);
  image_sub_.registerCallback([this](const sensor_msgs::ImageConstPtr&) { ++images_since_report_; });
  info_sub_.registerCallback([this](const sensor_msgs::CameraInfoConstPtr&) { ++infos_since_report_; });
  timer_ = node.createWallTimer(ros::WallDuration(kReportPeriod_s), &CameraNode::reportUnpaired, this);
}

void CameraNode::reportUnpaired(const ros::WallTimerEvent&) {
  if (images_since_report_ > 0 && pairs_since_report_ == 0) {
    throttle_.error(infos_since_report_ == 0
                        ? "no features: images arrive on " + image_sub_.getTopic() + ", but no intrinsics on " +
                              info_sub_.getTopic()
                        : "no features: no camera_info carries the stamp of an image (both must be equal)");
  }
  images_since_report_ = infos_since_report_ = pairs_since_report_ = 0;
}

void CameraNode::useIntrinsics(const CameraInfo& info) {
  const CameraIntrinsics intrinsics = toIntrinsics(info);
  if (!extractor_) {
    extractor_ = std::make_unique<MomentExtractor>(intrinsics, config_);
  } else if (!(extractor_->intrinsics() == intrinsics)) {
    extractor_->setIntrinsics(intrinsics);
    photometric_.reset();
    matches_.reset();
    tag_.reset();
  }
  if (config_.photometric && !photometric_)
    photometric_ = std::make_unique<PhotometricExtractor>(intrinsics, *config_.photometric);
  if (config_.matches && !matches_) matches_ = std::make_unique<MatchExtractor>(intrinsics, *config_.matches);
  if (config_.tag && !tag_) tag_ = std::make_unique<TagExtractor>(intrinsics, *config_.tag);
}

void CameraNode::onPair(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info) {
  ++pairs_since_report_;
  if (depths_) {
    depths_->addImage(image, info, DepthPairing::Clock::now());
  } else {
    process(image, info, nullptr);
  }
}

std::optional<DepthView> CameraNode::depthOf(const sensor_msgs::ImageConstPtr& depth) {
  try {
    if (depth) return toDepthView(*depth);
    if (depths_) throttle_.error("images without depth: none of their stamp comes on " + depth_sub_.getTopic());
  } catch (const ShapeError& error) {
    throttle_.error(error.what());
  }
  return std::nullopt;
}

void CameraNode::process(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
                         const sensor_msgs::ImageConstPtr& depth_image) {
  try {
    useIntrinsics(*info);
    if (image->header.stamp < last_stamp_) extractor_->forgetPrevious();  // the simulator was reset
    const ImageView view = toView(*image);
    const std::optional<DepthView> depth = depthOf(depth_image);
    extractor_->process(view, nanoseconds(image->header.stamp), depth ? &*depth : nullptr);
    if (photometric_) photometric_->process(view, nanoseconds(image->header.stamp));
    if (matches_) matches_->process(view, nanoseconds(image->header.stamp), depth ? &*depth : nullptr);
    if (tag_) tag_->process(view, nanoseconds(image->header.stamp));
    last_stamp_ = image->header.stamp;
    publish(*image, view);
  } catch (const ArasError& error) {
    throttle_.error(std::string("no features: ") + error.what());
  }
}

void CameraNode::publish(const Image& image, const ImageView& view) {
  const double age_s = (ros::Time::now() - image.header.stamp).toSec();
  publishFeatures(extractor_, image.header, age_s, features_pub_);
  publishFeatures(photometric_, image.header, age_s, photometric_pub_);
  publishFeatures(matches_, image.header, age_s, matches_pub_);
  publishFeatures(tag_, image.header, age_s, tag_pub_);
  if (converted_pub_.getNumSubscribers() > 0) {
    Image converted = emptyImage(image.header, view, sensor_msgs::image_encodings::MONO8, 1);
    converted.data.resize(static_cast<std::size_t>(converted.step) * converted.height);
    extractor_->mask().render(converted.data.data());
    converted_pub_.publish(converted);
  }
  if (overlay_pub_.getNumSubscribers() > 0) {
    Image overlay = emptyImage(image.header, view, sensor_msgs::image_encodings::RGB8, 3);
    overlay.data = drawOverlay(view, extractor_->mask(), extractor_->features(), extractor_->intrinsics());
    overlay_pub_.publish(overlay);
  }
}

void CameraNode::setReference(const aras_visual_servo_msgs::SetReference::Request& request,
                              aras_visual_servo_msgs::SetReference::Response* response) {
  if (!extractor_) throw DegenerateFeature("reference: found no image with valid intrinsics yet, allowed after one");
  const bool by_stamp = !request.stamp.isZero();
  if (by_stamp && request.from_current_view)
    throw ParameterError("reference: found a stamp and from_current_view, allowed one of them");
  if (!by_stamp && !request.from_current_view) {
    extractor_->setReference(request.z_star_m, request.area_star, request.alpha_star);
    return;
  }
  const ros::Time stamp = by_stamp ? request.stamp : last_stamp_;
  const std::int64_t stamp_ns = nanoseconds(stamp);
  if (photometric_) photometric_->teach(stamp_ns, request.z_star_m);
  if (matches_) matches_->teach(stamp_ns, request.z_star_m);
  if (tag_) tag_->teach(stamp_ns, request.z_star_m);
  try {
    extractor_->teach(stamp_ns, request.z_star_m);
  } catch (const DegenerateFeature& error) {
    if (!photometric_ && !matches_ && !tag_) throw;
    response->message = std::string("without moments: ") + error.what();
  }
  response->stamp = stamp;
}

bool CameraNode::onSetReference(aras_visual_servo_msgs::SetReference::Request& request,
                                aras_visual_servo_msgs::SetReference::Response& response) {
  try {
    setReference(request, &response);
    response.success = true;
  } catch (const ArasError& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace aras_visual_servo_camera
