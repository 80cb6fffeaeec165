#include "aras_visual_servo_camera/image/pixel_map.hpp"

namespace aras_visual_servo_camera {

PixelMap::PixelMap(const CameraIntrinsics& intrinsics, bool rays) : intrinsics_(intrinsics) {
  for (int v = 0; rays && v < height(); ++v)
    for (int u = 0; u < width(); ++u) rays_.push_back(intrinsics.rayOf(u, v));
  const auto sees = [&](int u, int v) { return intrinsics.undistort(u, v).valid; };
  const int right = width() - 1, last = height() - 1;
  if (!intrinsics.distorted() && sees(0, 0) && sees(right, 0) && sees(0, last) && sees(right, last)) {
    area_ = 1.0 / (intrinsics.fx() * intrinsics.fy());
    for (int u = 0; u < width(); ++u) x_of_u_.push_back((u - intrinsics.cx()) / intrinsics.fx());
    for (int v = 0; v < height(); ++v) y_of_v_.push_back((v - intrinsics.cy()) / intrinsics.fy());
    return;
  }
  pixels_.reserve(static_cast<std::size_t>(width()) * height());
  for (int v = 0; v < height(); ++v) {
    for (int u = 0; u < width(); ++u) {
      const CameraIntrinsics::Undistorted ray = intrinsics.undistort(u, v);
      const auto& J = ray.jacobian;
      pixels_.push_back(ray.valid ? Pixel{ray.x, ray.y, J[0] * J[3] - J[1] * J[2]} : Pixel{0.0, 0.0, 0.0});
    }
  }
}

}  // namespace aras_visual_servo_camera
