#include "conversions.hpp"

#include <pybind11/stl.h>

#include <string>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/overlay.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {

ImageView viewOf(const py::array& image) {
  const bool grey = image.ndim() == 2;
  const bool colour = image.ndim() == 3 && (image.shape(2) == 3 || image.shape(2) == 4);
  const bool deep = py::isinstance<py::array_t<std::uint16_t>>(image) && (grey || image.shape(2) == 3);
  if (!(deep || py::isinstance<py::array_t<std::uint8_t>>(image)) || !(grey || colour))
    throw ShapeError("image: found " + std::string(py::str(image.attr("dtype"))) + " of shape " +
                     std::string(py::str(image.attr("shape"))) +
                     ", allowed uint8 of shape (h, w), (h, w, 3) or (h, w, 4), or uint16 of the first two");
  const py::ssize_t size = image.itemsize(), depth = (grey ? 1 : image.shape(2)) * size;
  const bool rows_contiguous = image.shape(1) <= 1 || image.strides(1) == depth;
  const bool odd = image.strides(0) % size != 0;
  if (!rows_contiguous || (colour && image.strides(2) != size) || image.strides(0) < image.shape(1) * depth || odd)
    throw ShapeError("image: found strides " + std::string(py::str(image.attr("strides"))) +
                     ", allowed contiguous rows (numpy.ascontiguousarray)");
  ImageView view;
  view.data = static_cast<const std::uint8_t*>(image.data());
  view.width_px = static_cast<int>(image.shape(1));
  view.height_px = static_cast<int>(image.shape(0));
  view.step_bytes = static_cast<std::size_t>(image.strides(0));
  if (deep) {
    view.format = grey ? PixelFormat::kMono16 : PixelFormat::kRgb16;
  } else {
    view.format = grey ? PixelFormat::kMono8 : (depth == 3 ? PixelFormat::kRgb8 : PixelFormat::kRgba8);
  }
  return view;
}

DepthView depthOf(const py::array& depth) {
  DepthView view;
  view.millimetres = py::isinstance<py::array_t<std::uint16_t>>(depth);
  if (!(view.millimetres || py::isinstance<py::array_t<float>>(depth)) || depth.ndim() != 2 ||
      (depth.shape(1) > 1 && depth.strides(1) != depth.itemsize()) ||
      depth.strides(0) < depth.shape(1) * depth.itemsize())
    throw ShapeError("depth: found " + std::string(py::str(depth.attr("dtype"))) + " of shape " +
                     std::string(py::str(depth.attr("shape"))) +
                     ", allowed float32 [m] or uint16 [mm] of shape (h, w) with contiguous rows");
  view.data = static_cast<const std::uint8_t*>(depth.data());
  view.width_px = static_cast<int>(depth.shape(1));
  view.height_px = static_cast<int>(depth.shape(0));
  view.step_bytes = static_cast<std::size_t>(depth.strides(0));
  return view;
}

py::array inRgb(const py::array& image, const std::string& encoding) {
  const PixelFormat format = formatNamed(encoding);
  ImageView view = viewOf(image);
  if (channels(format) != channels(view.format) || isDeep(format) != isDeep(view.format))
    throw ShapeError("image: found " + std::string(py::str(image.attr("dtype"))) + " of shape " +
                     std::string(py::str(image.attr("shape"))) + ", allowed that of " + encoding);
  if (format != PixelFormat::kBgr8 && !isBayer(format)) return image;
  view.format = format;
  py::array_t<std::uint8_t> out({view.height_px, view.width_px, 3});
  toRgb(view, out.mutable_data());
  return out;
}

MomentFeatures toFeatures(const py::object& object) {
  if (py::isinstance<MomentFeatures>(object)) return object.cast<MomentFeatures>();
  MomentFeatures f;
  f.target_visible = object.attr("target_visible").cast<bool>();
  f.touches_border = object.attr("touches_border").cast<bool>();
  f.symmetric = object.attr("symmetric").cast<bool>();
  f.valid = object.attr("valid").cast<bool>();
  f.area = object.attr("area").cast<double>();
  f.alpha = object.attr("alpha").cast<double>();
  f.mu = object.attr("mu").cast<std::vector<double>>();
  if (py::hasattr(object, "point_x")) {  // messages recorded before there were points do without
    f.point_x = object.attr("point_x").cast<std::vector<double>>();
    f.point_y = object.attr("point_y").cast<std::vector<double>>();
  }
  if (py::hasattr(object, "ray_x")) {
    f.ray_x = object.attr("ray_x").cast<std::vector<double>>();
    f.ray_y = object.attr("ray_y").cast<std::vector<double>>();
    f.ray_z = object.attr("ray_z").cast<std::vector<double>>();
  }
  return f;
}

}  // namespace aras_visual_servo_camera
