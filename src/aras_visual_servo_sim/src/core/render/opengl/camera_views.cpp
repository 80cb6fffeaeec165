#include "camera_views.hpp"

#include "render/opengl/gl/packed_pixel.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Means over squares of 2 x 2 pixels. */
template <typename Pixel>
void halve(const std::vector<Pixel>& from, int width, std::vector<Pixel>& to) {
  to.resize(from.size() / 4);
  for (std::size_t k = 0; k < to.size(); ++k) {
    const std::size_t u = k % std::size_t(width / 2), v = k / std::size_t(width / 2);
    typename Packed<Pixel>::Mean mean;
    for (const std::size_t at : {0, 1, width, width + 1}) mean.add(from[2 * v * width + 2 * u + at]);
    to[k] = mean.of4();
  }
}

}  // namespace

CameraViews::CameraViews(const GlFunctions& gl, const CameraModel& camera, bool fine) : gl_(gl), fine_(fine) {
  const bool centers = camera.sampling() == CameraModel::Sampling::kCenter;
  const bool high = camera.config().quality == "high" && !centers;
  if (camera.lens() == CameraModel::Lens::kNone) {
    factor_ = high ? 2 : 1;
    views_.push_back(PinholeView::of(camera).scaled(factor_));
  } else {
    lens_ = std::make_unique<LensMap>(camera, high);
    views_ = lens_->views();
  }
  for (const PinholeView& view : views_) {
    canvases_.push_back(std::make_unique<Canvas>(gl, view.width, view.height, !centers, fine));
  }
}

const Canvas& CameraViews::singleSampled() {
  if (!single_sampled_) {
    const PinholeView& view = views_[0];
    single_sampled_ =
        std::make_unique<Canvas>(gl_, view.width, view.height, /*multisampled=*/false, fine_, /*deep=*/false);
  }
  return *single_sampled_;
}

template <typename Pixel>
void CameraViews::readWith(std::vector<std::vector<Pixel>>& pictures, std::vector<Pixel>& image) {
  if (!lens_ && factor_ == 1) return canvases_[0]->read(image);
  pictures.resize(canvases_.size());
  for (std::size_t k = 0; k < canvases_.size(); ++k) canvases_[k]->read(pictures[k]);
  if (lens_) {
    lens_->resample(pictures, image);
  } else {
    halve(pictures[0], views_[0].width, image);
  }
}

template void CameraViews::readWith(std::vector<std::vector<std::uint32_t>>&, std::vector<std::uint32_t>&);
template void CameraViews::readWith(std::vector<std::vector<std::uint64_t>>&, std::vector<std::uint64_t>&);

}  // namespace aras_visual_servo_sim
