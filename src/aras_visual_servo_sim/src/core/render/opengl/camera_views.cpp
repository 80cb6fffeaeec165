#include "camera_views.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Means over squares of 2 x 2 pixels. */
void halve(const std::vector<std::uint32_t>& from, int width, std::vector<std::uint32_t>& to) {
  constexpr std::uint32_t kEven = 0x00ff00ff;
  to.resize(from.size() / 4);
  for (std::size_t k = 0; k < to.size(); ++k) {
    const std::size_t u = k % std::size_t(width / 2), v = k / std::size_t(width / 2);
    std::uint32_t even = 0x00020002, odd = 0x00020002;
    for (const std::size_t at : {0, 1, width, width + 1}) {
      const std::uint32_t pixel = from[2 * v * width + 2 * u + at];
      even += pixel & kEven;
      odd += (pixel >> 8) & kEven;
    }
    to[k] = ((even >> 2) & kEven) | (((odd >> 2) & kEven) << 8);
  }
}

}  // namespace

CameraViews::CameraViews(const GlFunctions& gl, const CameraModel& camera) {
  const bool centers = camera.sampling() == CameraModel::Sampling::kCenter;
  const bool fine = camera.config().quality == "high" && !centers;
  if (camera.lens() == CameraModel::Lens::kNone) {
    factor_ = fine ? 2 : 1;
    views_.push_back(PinholeView::of(camera).scaled(factor_));
  } else {
    lens_ = std::make_unique<LensMap>(camera, fine);
    views_ = lens_->views();
  }
  for (const PinholeView& view : views_) {
    canvases_.push_back(std::make_unique<Canvas>(gl, view.width, view.height, !centers));
  }
  pictures_.resize(views_.size());
}

void CameraViews::read(std::vector<std::uint32_t>& image) {
  if (!lens_ && factor_ == 1) return canvases_[0]->read(image);
  for (std::size_t k = 0; k < canvases_.size(); ++k) canvases_[k]->read(pictures_[k]);
  if (lens_) {
    lens_->resample(pictures_, image);
  } else {
    halve(pictures_[0], views_[0].width, image);
  }
}

}  // namespace aras_visual_servo_sim
