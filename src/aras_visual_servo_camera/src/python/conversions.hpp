#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"

namespace aras_visual_servo_camera {

/** A view of a uint8 or uint16 array with contiguous rows.
 *  @param format  of the array; without one its shape says it: (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba
 *  @throws ShapeError for another shape, type or layout within a row */
ImageView viewOf(const pybind11::array& image, std::optional<PixelFormat> format = std::nullopt);

/** A view of a float32 [m] or uint16 [mm] array of shape (h, w) with contiguous rows.
 *  @throws ShapeError for another shape, type or layout within a row */
DepthView depthOf(const pybind11::array& depth);

/** The image as the extractors take it: itself, or, where its values are not grey, rgb or rgba, a new one of rgb.
 *  @param encoding  of the camera, a name of sensor_msgs
 *  @throws ShapeError for an encoding that formatNamed refuses, or another shape or type than it has */
pybind11::array inRgb(const pybind11::array& image, const std::string& encoding);

/** A MomentFeatures, or anything with its attributes (the ROS message). */
MomentFeatures toFeatures(const pybind11::object& object);

}  // namespace aras_visual_servo_camera
