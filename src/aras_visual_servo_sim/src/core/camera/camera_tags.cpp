#include "aras_visual_servo_sim/camera/camera_tags.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/camera/equidistant_lens.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kSamePlace = 1e-6;    // [m], [rad]: what rounding of a URDF's numbers amounts to
constexpr double kSameFocal = 1e-2;    // [px]: a focal length written with two digits
constexpr double kGreyLevels = 255.0;  // Gazebo's noise is of intensities 0 .. 1

/** From Gazebo's camera axes (x forward, y left, z up) to optical ones. */
Pose opticalInSensor() {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {Eigen::Vector3d::Zero(), Eigen::Quaterniond(R)};
}

bool bends(const std::vector<double>& lens) {
  return std::any_of(lens.begin(), lens.end(), [](double coefficient) { return coefficient != 0.0; });
}

/** Turns one tag into a camera, collecting what Gazebo does otherwise. */
class TagReader {
 public:
  TagReader(const RobotModel& model, const CameraTag& tag, std::vector<std::string>& warnings)
      : model_(model), tag_(tag), warnings_(warnings) {
    camera_.name = !tag.camera_name.empty() ? tag.camera_name : tag.sensor_name;
    camera_.name.erase(0, camera_.name.find_first_not_of('/'));
  }

  CameraConfig read(bool as_gazebo) {
    camera_.width = tag_.width;
    camera_.height = tag_.height;
    camera_.encoding = encoding();
    if (tag_.update_rate_hz > 0.0) {
      camera_.rate_hz = tag_.update_rate_hz;
    } else {
      warn("no <update_rate>, which is as often as possible in Gazebo: 30 Hz is taken");
    }
    if (tag_.near_m > 0.0) camera_.near_m = tag_.near_m;
    if (tag_.far_m > 0.0) camera_.far_m = tag_.far_m;
    camera_.noise_mean = kGreyLevels * tag_.noise_mean;
    camera_.noise_stddev = kGreyLevels * tag_.noise_stddev;
    camera_.baseline_m = tag_.baseline;
    camera_.triggered = tag_.triggered;
    // The f and D that Gazebo gives a fisheye describe no lens at all.
    const bool told_as_gazebo = as_gazebo && !tag_.fisheye;
    if (told_as_gazebo) {
      readAsGazebo();
    } else {
      readFocalLength();
      readCenter("Cx", tag_.cx, tag_.width, camera_.cx_px);
      readCenter("Cy", tag_.cy, tag_.height, camera_.cy_px);
      readLens();
    }
    readPlace();
    if (told_as_gazebo) warnOfFold();
    return camera_;
  }

 private:
  void warn(const std::string& text) {
    warnings_.push_back(model_.source_name + ": camera '" + camera_.name + "': " + text);
  }

  std::string encoding() const {
    static const std::map<std::string, std::string> known = {{"", "rgb8"},
                                                             {"R8G8B8", "rgb8"},
                                                             {"RGB_INT8", "rgb8"},
                                                             {"B8G8R8", "bgr8"},
                                                             {"BGR_INT8", "bgr8"},
                                                             {"L8", "mono8"},
                                                             {"L_INT8", "mono8"},
                                                             {"R16G16B16", "rgb16"},
                                                             {"RGB_INT16", "rgb16"},
                                                             {"L16", "mono16"},
                                                             {"L_INT16", "mono16"},
                                                             {"BAYER_RGGB8", "bayer_rggb8"},
                                                             {"BAYER_BGGR8", "bayer_bggr8"},
                                                             {"BAYER_GBRG8", "bayer_gbrg8"},
                                                             {"BAYER_GRBG8", "bayer_grbg8"}};
    const auto found = known.find(tag_.format);
    if (found != known.end()) return found->second;
    throw ModelError(
        "camera '" + camera_.name + "': <format> is " + tag_.format +
        ", allowed R8G8B8, B8G8R8, L8, R16G16B16, L16, BAYER_RGGB8, BAYER_BGGR8, BAYER_GBRG8, BAYER_GRBG8");
  }

  /** The image by the sensor alone, camera_info by the plugin's keys and defaults (gazebo_ros_camera_utils.cpp). */
  void readAsGazebo() {
    const double field = tag_.horizontal_fov_rad;
    if (field > 0.0) camera_.horizontal_fov_rad = field;
    if (!tag_.sensor_distortion.empty()) {
      camera_.distortion = tag_.sensor_distortion;
      camera_.distortion_model = "plumb_bob";
    }
    ToldIntrinsics told;
    told.f_px = tag_.focal_length != 0.0 ? tag_.focal_length : 0.5 * tag_.width / std::tan(0.5 * field);
    told.cx_px = tag_.cx != 0.0 ? tag_.cx : 0.5 * (tag_.width + 1);
    told.cy_px = tag_.cy != 0.0 ? tag_.cy : 0.5 * (tag_.height + 1);
    told.distortion = tag_.auto_distortion ? tag_.sensor_distortion : tag_.distortion;
    if (told.distortion.empty()) told.distortion.assign(5, 0.0);
    camera_.told = told;
    warn("sim/compatibility: gazebo: camera_info says what Gazebo's does, which is not how the image is drawn");
  }

  /** Gazebo draws through any lens. */
  void warnOfFold() {
    constexpr double kSeen = 0.5;  // [px]
    if (!bends(camera_.distortion)) return;
    try {
      const CameraModel drawn(camera_);
      const Eigen::Vector2d corner(-0.5, -0.5);
      const Eigen::Vector3d ray = drawn.unproject(corner.x(), corner.y());
      if ((drawn.toPixel(ray.x() / ray.z(), ray.y() / ray.z()) - corner).norm() < kSeen) return;
      warn("<distortion>: the lens folds over inside the image; what lies beyond shows what is nearest to it");
    } catch (const ParameterError&) {  // the simulation says what is wrong with the camera, with all other faults
    }
  }

  void readFocalLength() {
    const double field = tag_.horizontal_fov_rad;
    if (field > 0.0) camera_.horizontal_fov_rad = field;
    if (tag_.focal_length == 0.0) return;
    const double expected = 0.5 * tag_.width / (tag_.fisheye ? 0.5 * field : std::tan(0.5 * field));
    if (std::abs(tag_.focal_length - expected) <= kSameFocal) return;
    camera_.horizontal_fov_rad.reset();
    camera_.fx_px = camera_.fy_px = tag_.focal_length;
    warn("<focalLength> " + std::to_string(tag_.focal_length) + " px is not that of <horizontal_fov>, " +
         std::to_string(expected) + " px: the image is drawn with it too, Gazebo's is not");
  }

  void readCenter(const char* key, double value, int size, std::optional<double>& center) {
    if (value == 0.0) return;
    center = value;
    if (value == 0.5 * (size - 1)) return;
    warn(std::string("<") + key + "> " + std::to_string(value) +
         " px is not the middle of the image: the image is drawn with it too, Gazebo's is not");
  }

  void readLens() {
    const std::vector<double>&drawn = tag_.sensor_distortion, &told = tag_.distortion;
    if (tag_.fisheye) {
      camera_.distortion_model = "equidistant";
      camera_.cutoff_angle_rad = std::min(tag_.cutoff_angle_rad, EquidistantLens::kWidest);
      if (tag_.cutoff_angle_rad > EquidistantLens::kWidest) {
        warn("<cutoff_angle> " + std::to_string(tag_.cutoff_angle_rad) + " rad: nothing beyond 2.18 rad is drawn");
      }
      const bool polynomial = drawn.size() == 4;  // of the lens; a <distortion> has five
      if (polynomial) camera_.distortion = drawn;
      if ((bends(drawn) && !polynomial) || bends(told)) {
        warn("<distortion> and distortionK1 ... are ignored: image and camera_info have the equidistant lens");
      }
      return;
    }
    if (!drawn.empty()) {
      camera_.distortion = drawn;
      if (!tag_.auto_distortion && bends(drawn) && drawn != told) {
        warn("camera_info has the sensor's <distortion>; Gazebo's has the plugin's distortionK1 ..., which differ");
      }
    } else if (!told.empty()) {
      camera_.distortion = told;
      if (bends(told)) warn("the image is drawn through the lens of distortionK1 ...; Gazebo's has no lens");
    }
    if (!camera_.distortion.empty()) camera_.distortion_model = "plumb_bob";
  }

  /** The sensor's place, or the link <frameName> names where that is the same place. */
  void readPlace() {
    const Pose X_LC = tag_.X_link_sensor * opticalInSensor();
    camera_.frame = !tag_.frame.empty() ? tag_.frame : tag_.link;
    const std::optional<Pose> X_LF = poseInSensorLink(camera_.frame);
    if (X_LF && (X_LF->p - X_LC.p).norm() <= kSamePlace && X_LF->q.angularDistance(X_LC.q) <= kSamePlace) return;
    camera_.mount = tag_.link;
    camera_.X_MC = X_LC;
    warn("frame '" + camera_.frame + "' is not the optical frame (x right, y down, z forward) of the sensor on link '" +
         tag_.link + "': images and poses are those of the sensor, as in Gazebo");
  }

  /** Pose of a link in the sensor's link, if fixed joints lead there. */
  std::optional<Pose> poseInSensorLink(const std::string& name) const {
    int index = find(name);
    const int target = find(tag_.link);
    Pose pose;
    while (index >= 0 && index != target) {
      const int joint = model_.links[index].parent_joint;
      if (joint < 0 || model_.joints[joint].moves()) return std::nullopt;
      pose = model_.joints[joint].X_PJ * pose;
      index = model_.joints[joint].parent_link;
    }
    return index < 0 ? std::nullopt : std::optional<Pose>(pose);
  }

  int find(const std::string& link) const {
    const auto found =
        std::find_if(model_.links.begin(), model_.links.end(), [&link](const Link& each) { return each.name == link; });
    return found == model_.links.end() ? -1 : static_cast<int>(found - model_.links.begin());
  }

  const RobotModel& model_;
  const CameraTag& tag_;
  std::vector<std::string>& warnings_;
  CameraConfig camera_;
};

}  // namespace

std::vector<CameraConfig> camerasFromTags(const RobotModel& model, std::vector<std::string>& warnings, bool as_gazebo) {
  std::vector<CameraConfig> cameras;
  for (const CameraTag& tag : model.cameras) cameras.push_back(TagReader(model, tag, warnings).read(as_gazebo));
  return cameras;
}

}  // namespace aras_visual_servo_sim
