#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "aras_visual_servo_camera/image/depth_view.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"

namespace aras_visual_servo_camera {

/** A view of a uint8 array of shape (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, or a uint16 one of the first two,
 *  with contiguous rows.
 *  @throws ShapeError for another shape, type or layout within a row */
ImageView viewOf(const pybind11::array& image);

/** A view of a float32 [m] or uint16 [mm] array of shape (h, w) with contiguous rows.
 *  @throws ShapeError for another shape, type or layout within a row */
DepthView depthOf(const pybind11::array& depth);

/** A MomentFeatures, or anything with its attributes (the ROS message). */
MomentFeatures toFeatures(const pybind11::object& object);

}  // namespace aras_visual_servo_camera
