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
  const PixelFormat format = grey         ? (deep ? PixelFormat::kMono16 : PixelFormat::kMono8)
                             : deep       ? PixelFormat::kRgb16
                             : depth == 3 ? PixelFormat::kRgb8
                                          : PixelFormat::kRgba8;
  return {static_cast<const std::uint8_t*>(image.data()), static_cast<int>(image.shape(1)),
          static_cast<int>(image.shape(0)), static_cast<std::size_t>(image.strides(0)), format};
}

DepthView depthOf(const py::array& depth) {
  const bool millimetres = py::isinstance<py::array_t<std::uint16_t>>(depth);
  if (!(millimetres || py::isinstance<py::array_t<float>>(depth)) || depth.ndim() != 2 ||
      (depth.shape(1) > 1 && depth.strides(1) != depth.itemsize()) ||
      depth.strides(0) < depth.shape(1) * depth.itemsize())
    throw ShapeError("depth: found " + std::string(py::str(depth.attr("dtype"))) + " of shape " +
                     std::string(py::str(depth.attr("shape"))) +
                     ", allowed float32 [m] or uint16 [mm] of shape (h, w) with contiguous rows");
  return {static_cast<const std::uint8_t*>(depth.data()), static_cast<int>(depth.shape(1)),
          static_cast<int>(depth.shape(0)), static_cast<std::size_t>(depth.strides(0)), millimetres};
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
  object.attr("valid");  // an AttributeError where the object is nothing like features
  MomentFeatures f;
  // Messages that were recorded before there were points, rays or kernels do without these fields.
#define ARAS_TAKE(field) \
  if (py::hasattr(object, #field)) f.field = object.attr(#field).cast<decltype(f.field)>();
  ARAS_MOMENT_FIELDS(ARAS_TAKE)
  return f;
}

}  // namespace aras_visual_servo_camera
