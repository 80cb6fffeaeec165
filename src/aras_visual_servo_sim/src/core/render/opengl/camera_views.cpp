#include "camera_views.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

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

/** How much finer than the image, where the lens is finest, pictures are. */
constexpr double kFiner = 1.4;

/** Frames that look ahead, right, left, down and up. */
std::vector<Eigen::Matrix3d> directionsOf(const CameraModel& camera) {
  std::vector<Eigen::Matrix3d> R_FC{Eigen::Matrix3d::Identity()};
  if (camera.lens() != CameraModel::Lens::kEquidistant) return R_FC;
  for (const double yaw : {0.5 * M_PI, -0.5 * M_PI}) {
    R_FC.emplace_back(Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitY()).toRotationMatrix());
  }
  for (const double pitch : {0.5 * M_PI, -0.5 * M_PI}) {
    R_FC.emplace_back(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()).toRotationMatrix());
  }
  return R_FC;
}

/** The one that a ray is nearest to the axis of. */
std::size_t faceOf(const std::vector<Eigen::Matrix3d>& R_FC, const Eigen::Vector3d& ray) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < R_FC.size(); ++k) {
    if (R_FC[k].row(2).dot(ray) > R_FC[best].row(2).dot(ray) + 1e-12) best = k;
  }
  return best;
}

/** Pixels of the image for one of x = X / Z, where there are most of them. */
double finestScale(const CameraModel& camera) {
  if (camera.lens() == CameraModel::Lens::kEquidistant) return std::max(camera.fx(), camera.fy());
  double finest = 0.0;
  constexpr int kPlaces = 16;
  constexpr double kStep = 1e-5;
  for (int i = 0; i <= kPlaces; ++i) {
    for (int j = 0; j <= kPlaces; ++j) {
      const Eigen::Vector3d ray =
          camera.unproject(double(i) / kPlaces * (camera.width() - 1), double(j) / kPlaces * (camera.height() - 1));
      const double x = ray.x() / ray.z(), y = ray.y() / ray.z();
      const Eigen::Vector2d here = camera.toPixel(x, y);
      finest = std::max({finest, (camera.toPixel(x + kStep, y) - here).norm() / kStep,
                         (camera.toPixel(x, y + kStep) - here).norm() / kStep});
    }
  }
  return finest;
}

}  // namespace

/** How the image of a camera with a lens is put together from pictures without one.
 *
 *  A polynomial lens takes one picture ahead, the equidistant one the faces of a cube that it sees. Each picture is as
 *  large as the image needs. A pixel is interpolated where the ray through its centre, or the rays through the centres
 *  of its quarters, meet a picture. */
class LensMap {
 public:
  /** @param camera  with a lens  @param fine  pictures twice as fine, and four rays a pixel */
  LensMap(const CameraModel& camera, bool fine) : rays_(fine ? 4 : 1) {
    const std::vector<Eigen::Matrix3d> R_FC = directionsOf(camera);
    const double f = kFiner * (fine ? 2.0 : 1.0) * finestScale(camera);
    std::vector<Ray> rays;
    rays.reserve(std::size_t(rays_) * camera.width() * camera.height());
    const Eigen::Array2d none(1e9, -1e9);  // least and greatest of nothing
    std::vector<std::array<Eigen::Array2d, 2>> spans(R_FC.size(), {none, none});
    const auto add = [&](const Eigen::Vector3d& ray) {
      const std::size_t face = faceOf(R_FC, ray);
      const Eigen::Vector3d p = R_FC[face] * ray;
      rays.push_back({face, p.x() / p.z(), p.y() / p.z(), p.z() > 0.0});
      if (!rays.back().drawn) return;  // farther from the axis than any face is
      for (int axis = 0; axis < 2; ++axis) {
        const double value = axis == 0 ? rays.back().x : rays.back().y;
        spans[face][axis] = {std::min(spans[face][axis][0], value), std::max(spans[face][axis][1], value)};
      }
    };
    const bool circle = camera.showsLensCircle();
    for (int v = 0; v < camera.height(); ++v) {
      for (int u = 0; u < camera.width(); ++u) {
        if (!fine) {
          add(camera.pixelRay(u, v));
          continue;
        }
        for (int k = 0; k < 4; ++k) {
          const double x = u + (k % 2 ? 0.25 : -0.25), y = v + (k / 2 ? 0.25 : -0.25);
          add(!circle || camera.isWithinLens(x, y) ? camera.unproject(x, y) : camera.pixelRay(u, v));
        }
      }
    }
    std::vector<std::size_t> view_of(R_FC.size(), kNone);
    for (std::size_t face = 0; face < R_FC.size(); ++face) {
      const auto& [x, y] = spans[face];
      if (!(x[0] <= x[1])) continue;
      constexpr int kMargin = 2;  // [px] for the neighbours that are interpolated with
      PinholeView view;
      view.R_FC = R_FC[face];
      view.fx = view.fy = f;
      view.cx = kMargin - std::floor(f * x[0]);
      view.cy = kMargin - std::floor(f * y[0]);
      view.width = static_cast<int>(std::ceil(f * x[1]) + view.cx) + kMargin + 1;
      view.height = static_cast<int>(std::ceil(f * y[1]) + view.cy) + kMargin + 1;
      view_of[face] = views_.size();
      views_.push_back(view);
    }
    taps_.reserve(rays.size());
    for (const Ray& ray : rays) {
      if (!ray.drawn) {
        taps_.push_back({0, kNone, 0, 0});
        continue;
      }
      const PinholeView& view = views_[view_of[ray.face]];
      const double u = f * ray.x + view.cx, v = f * ray.y + view.cy;
      const auto column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
      const auto part = [](double value) { return static_cast<std::uint8_t>(std::min(255.0, 256.0 * value)); };
      taps_.push_back(
          {row * view.width + column, static_cast<std::uint8_t>(view_of[ray.face]), part(u - column), part(v - row)});
    }
  }

  const std::vector<PinholeView>& views() const { return views_; }

  /** @param pictures  of views(), in their order, pixels as Canvas::read gives them
   *  @param image     width x height of the camera; where no picture has anything it becomes black */
  template <typename Pixel>
  void resample(const std::vector<std::vector<Pixel>>& pictures, std::vector<Pixel>& image) const {
    using Channels = Packed<Pixel>;
    image.resize(taps_.size() / rays_);
    const auto see = [&](const Tap& tap) -> Pixel {
      if (tap.view == kNone) return 0;
      const Pixel* at = pictures[tap.view].data() + tap.first;
      const Pixel* below = at + views_[tap.view].width;
      return Channels::mix(Channels::mix(at[0], at[1], tap.right), Channels::mix(below[0], below[1], tap.right),
                           tap.down);
    };
    if (rays_ == 1) {
      for (std::size_t k = 0; k < image.size(); ++k) image[k] = see(taps_[k]);
      return;
    }
    for (std::size_t k = 0; k < image.size(); ++k) {
      typename Channels::Mean mean;
      for (int ray = 0; ray < rays_; ++ray) mean.add(see(taps_[rays_ * k + ray]));
      image[k] = mean.of4();
    }
  }

 private:
  struct Ray {
    std::size_t face;
    double x, y;  // where it meets the plane Z = 1 of the face
    bool drawn;
  };
  /** Where one ray meets a picture. */
  struct Tap {
    std::int32_t first;        ///< index of the upper left of four pixels
    std::uint8_t view;         ///< kNone: the ray meets nothing
    std::uint8_t right, down;  ///< weights of the others, in 256ths
  };
  static constexpr std::uint8_t kNone = 255;

  std::vector<PinholeView> views_;
  std::vector<Tap> taps_;  // of each pixel one or four
  int rays_ = 1;
};

CameraViews::CameraViews(const GlFunctions& gl, const CameraModel& camera, bool fine) : gl_(gl), fine_(fine) {
  const bool centers = camera.sampling() == CameraModel::Sampling::kCenter;
  const bool high = camera.config().quality == "high" && !centers;
  if (camera.lens() == CameraModel::Lens::kNone) {
    factor_ = high ? 2 : 1;
    views_.push_back(PinholeView::of(camera, factor_));
  } else {
    lens_ = std::make_unique<LensMap>(camera, high);
    views_ = lens_->views();
  }
  for (const PinholeView& view : views_) {
    canvases_.push_back(std::make_unique<Canvas>(gl, view.width, view.height, !centers, fine));
  }
}

CameraViews::~CameraViews() = default;

const Canvas& CameraViews::singleSampled(std::size_t k) {
  single_sampled_.resize(views_.size());
  if (!single_sampled_[k]) {
    const PinholeView& view = views_[k];
    single_sampled_[k] =
        std::make_unique<Canvas>(gl_, view.width, view.height, /*multisampled=*/false, fine_, /*deep=*/false);
  }
  return *single_sampled_[k];
}

template <typename Pixel>
std::vector<Pixel>& CameraViews::picture(std::size_t k, std::vector<Pixel>& image) {
  if (readsInParts()) return image;
  auto& pictures = std::get<std::vector<std::vector<Pixel>>>(pictures_);
  pictures.resize(views_.size());
  return pictures[k];
}

template <typename Pixel>
void CameraViews::compose(std::vector<Pixel>& image) {
  if (readsInParts()) return;
  const auto& pictures = std::get<std::vector<std::vector<Pixel>>>(pictures_);
  if (lens_) {
    lens_->resample(pictures, image);
  } else {
    halve(pictures[0], views_[0].width, image);
  }
}

template <typename Pixel>
void CameraViews::read(std::vector<Pixel>& image) {
  for (std::size_t k = 0; k < canvases_.size(); ++k) canvases_[k]->read(picture(k, image));
  compose(image);
}

template void CameraViews::read(std::vector<std::uint32_t>&);
template void CameraViews::read(std::vector<std::uint64_t>&);
template std::vector<std::uint32_t>& CameraViews::picture(std::size_t, std::vector<std::uint32_t>&);
template std::vector<std::uint64_t>& CameraViews::picture(std::size_t, std::vector<std::uint64_t>&);
template void CameraViews::compose(std::vector<std::uint32_t>&);
template void CameraViews::compose(std::vector<std::uint64_t>&);

}  // namespace aras_visual_servo_sim
