#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "polygon_moments.hpp"

namespace aras_visual_servo_camera::testing {

/** A grey image that owns its pixels. */
struct GreyImage {
  int width = 320, height = 240;
  std::vector<std::uint8_t> data;

  GreyImage(int w, int h, std::uint8_t grey) : width(w), height(h), data(static_cast<std::size_t>(w) * h, grey) {}
  std::uint8_t& at(int u, int v) { return data[static_cast<std::size_t>(v) * width + u]; }
  ImageView view() const { return {data.data(), width, height, static_cast<std::size_t>(width), PixelFormat::kMono8}; }
};

constexpr std::uint8_t kObjectGrey = 20, kBackgroundGrey = 230;

/** Draw a polygon of normalised coordinates as the camera sees it, each pixel by its exactly covered area (slow): the
 *  polygon, its edges subdivided where the lens bends them, is clipped to each pixel. */
void drawCoverage(const Polygon& normalised, const CameraIntrinsics& camera, std::uint8_t grey, GreyImage* image);

/** The same with one sample in the middle of each pixel: hard edges. */
void drawBinary(const Polygon& normalised, const CameraIntrinsics& camera, std::uint8_t grey, GreyImage* image);

GreyImage coverageImage(const Polygon& normalised, const CameraIntrinsics& camera);
GreyImage binaryImage(const Polygon& normalised, const CameraIntrinsics& camera);

/** Add normal noise, rounded and clipped to 0..255. */
void addNoise(double sigma, std::mt19937* random, GreyImage* image);

/** 320 x 240, f = 195.05 px, principal point in the middle; with the published lens when `distorted`. */
CameraIntrinsics testCamera(bool distorted = false);

}  // namespace aras_visual_servo_camera::testing
