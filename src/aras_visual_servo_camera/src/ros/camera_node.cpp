#include "camera_node.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <aras_visual_servo_common/ros/yaml_from_xmlrpc.hpp>
#include <aras_visual_servo_common/text.hpp>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/overlay.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::numberText;

constexpr int kQueue = 100;                    // images that may wait: none is dropped in normal running
constexpr std::uint32_t kFeatureQueue = 1000;  // messages: a listener that hesitates for seconds loses nothing
constexpr std::chrono::seconds kThrottlePeriod{10};
constexpr double kDepthPeriod_s = 0.05;  // wall time between looks at images that wait for depth
constexpr double kReportPeriod_s = 2.0;  // wall time without a pair after which the cause is reported
constexpr int kReportsOfLosses = 5;      // so many of these until losses are reported

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

/** Makes an extractor, or tells it that its camera has changed. */
template <typename Extractor, typename Settings>
void useIn(const CameraIntrinsics& intrinsics, const Settings& settings, std::unique_ptr<Extractor>* extractor) {
  if (!*extractor) {
    *extractor = std::make_unique<Extractor>(intrinsics, settings);
  } else if (!((*extractor)->intrinsics() == intrinsics)) {
    (*extractor)->setIntrinsics(intrinsics);
  }
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

CameraNode::CameraNode(ros::NodeHandle node, const ros::NodeHandle& private_node)
    : config_(readParameters(node, private_node)),
      pairs_(ros::Duration(config_.camera_info_slop_s),
             [this](const auto& image, const auto& info) { onPair(image, info); }) {
  features_pub_ = node.advertise<aras_visual_servo_msgs::MomentFeatures>("camera/features", kFeatureQueue);
  if (config_.photometric)
    photometric_pub_ = node.advertise<aras_visual_servo_msgs::PhotometricFeatures>("camera/photometric", kQueue);
  if (config_.tag) tag_pub_ = node.advertise<aras_visual_servo_msgs::TagFeatures>("camera/tag", kFeatureQueue);
  if (config_.matches)
    matches_pub_ = node.advertise<aras_visual_servo_msgs::MatchFeatures>("camera/matches", kFeatureQueue);
  converted_pub_ = node.advertise<Image>("camera/converted_image", kQueue);
  overlay_pub_ = node.advertise<Image>("camera/overlay", kQueue);
  reference_service_ = node.advertiseService("camera/set_reference", &CameraNode::onSetReference, this);
  subscribe(node, private_node);
  timer_ = node.createWallTimer(ros::WallDuration(kReportPeriod_s), &CameraNode::reportUnpaired, this);
}

void CameraNode::subscribe(ros::NodeHandle node, const ros::NodeHandle& private_node) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  info_sub_ = node.subscribe<CameraInfo>(
      "camera/camera_info", kQueue, [this](const sensor_msgs::CameraInfoConstPtr& info) { pairs_.addInfo(info); },
      ros::VoidConstPtr(), hints);
  const image_transport::TransportHints transport("raw", hints, private_node);
  try {
    image_sub_ = image_transport::ImageTransport(node).subscribe(
        "camera/image_raw", kQueue, [this](const sensor_msgs::ImageConstPtr& image) { pairs_.addImage(image); },
        ros::VoidPtr(), transport);
  } catch (const image_transport::Exception& error) {
    throw ParameterError(private_node.resolveName("image_transport") + ": found " + transport.getTransport() +
                         ", allowed raw and the transports installed here: " + error.what());
  }
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
}

void CameraNode::reportUnpaired(const ros::WallTimerEvent&) {
  const InfoPairing::Counts& counts = pairs_.counts();
  if (++quiet_reports_ < kReportsOfLosses && (counts.images == 0 || counts.pairs > 0)) return;
  const std::string remedy =
      " (allowed are stamps up to vision.camera_info_slop_s apart, " + numberText(config_.camera_info_slop_s) + " s)";
  if (counts.images > 0 && counts.pairs == 0) {
    throttle_.error(counts.infos == 0 ? "no features: images arrive on " + image_sub_.getTopic() +
                                            ", but no intrinsics on " + info_sub_.getTopic()
                                      : "no features: no camera_info carries the stamp of an image" + remedy);
  } else if (counts.lost > 0) {
    throttle_.error("images and camera_info pair only in part: of " + std::to_string(counts.images) + " images and " +
                    std::to_string(counts.infos) + " camera_infos in " + std::to_string(quiet_reports_ * 2) + " s, " +
                    std::to_string(counts.pairs) + " became pairs and " + std::to_string(counts.lost) +
                    " images gave no features, for want of a camera_info of their stamp" + remedy);
  }
  quiet_reports_ = 0;
  pairs_.resetCounts();
}

void CameraNode::useIntrinsics(const CameraInfo& info) {
  const CameraIntrinsics intrinsics = toIntrinsics(info);
  const bool known = extractor_ && extractor_->intrinsics() == intrinsics;
  if (!known && !intrinsics.foldWarning().empty()) ROS_WARN_STREAM("camera_node: " << intrinsics.foldWarning());
  useIn(intrinsics, config_, &extractor_);
  if (config_.photometric) useIn(intrinsics, *config_.photometric, &photometric_);
  if (config_.matches) useIn(intrinsics, *config_.matches, &matches_);
  if (config_.tag) useIn(intrinsics, *config_.tag, &tag_);
}

void CameraNode::onPair(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info) {
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
    const int white = extractor_->white();
    extractor_->process(view, nanoseconds(image->header.stamp), depth ? &*depth : nullptr);
    if (extractor_->white() != white)
      ROS_INFO_STREAM("camera_node: in images of " << image->encoding << " " << extractor_->white()
                                                   << " counts as white, the most that its values so far need");
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
    ImageView shown = view;
    if (extractor_->white() > 0) shown.white = extractor_->white();
    overlay.data = drawOverlay(shown, extractor_->mask(), extractor_->features(), extractor_->intrinsics());
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
  // All of them or none: an extractor that refuses leaves its own reference as it was.
  std::vector<std::function<void()>> undo;
  const auto teach = [&](const auto& extractor) {
    if (!extractor) return;
    auto back = extractor->undo();
    extractor->teach(stamp_ns, request.z_star_m);
    undo.push_back(std::move(back));
  };
  try {
    teach(photometric_);
    teach(matches_);
    teach(tag_);
    try {
      extractor_->teach(stamp_ns, request.z_star_m);
    } catch (const DegenerateFeature& error) {
      if (undo.empty()) throw;
      extractor_->clearReference();  // of another view
      response->message = std::string("without moments: ") + error.what();
    }
  } catch (...) {
    for (const auto& back : undo) back();
    throw;
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
