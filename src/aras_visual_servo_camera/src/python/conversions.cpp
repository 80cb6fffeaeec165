#include "conversions.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/overlay.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {

ImageView viewOf(const py::array& image, std::optional<PixelFormat> format) {
  const py::ssize_t values = image.ndim() == 2 ? 1 : image.ndim() == 3 ? image.shape(2) : 0;
  const bool deep = py::isinstance<py::array_t<std::uint16_t>>(image);
  const bool bytes = py::isinstance<py::array_t<std::uint8_t>>(image);
  const auto found = [&] {
    return "image: found " + std::string(py::str(image.attr("dtype"))) + " of shape " +
           std::string(py::str(image.attr("shape")));
  };
  if (!format) {
    if (!(deep || bytes) || !(values == 1 || values == 3 || values == 4))
      throw ShapeError(found() + ", allowed uint8 or uint16 of shape (h, w), (h, w, 3) or (h, w, 4)");
    format = values == 1   ? (deep ? PixelFormat::kMono16 : PixelFormat::kMono8)
             : values == 3 ? (deep ? PixelFormat::kRgb16 : PixelFormat::kRgb8)
                           : (deep ? PixelFormat::kRgba16 : PixelFormat::kRgba8);
  } else if (values != channels(*format) || !(isDeep(*format) ? deep : bytes)) {
    throw ShapeError(found() + ", allowed " + (isDeep(*format) ? "uint16" : "uint8") + " of " +
                     std::to_string(channels(*format)) + " values a pixel");
  }
  const py::ssize_t size = image.itemsize(), depth = values * size;
  const bool rows_contiguous = image.shape(1) <= 1 || image.strides(1) == depth;
  if (!rows_contiguous || (values > 1 && image.strides(2) != size) || image.strides(0) < image.shape(1) * depth)
    throw ShapeError("image: found strides " + std::string(py::str(image.attr("strides"))) +
                     ", allowed contiguous rows (numpy.ascontiguousarray)");
  return {static_cast<const std::uint8_t*>(image.data()), static_cast<int>(image.shape(1)),
          static_cast<int>(image.shape(0)), static_cast<std::size_t>(image.strides(0)), *format};
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
  const PixelFormat format = formatNamed(encoding), layout = shallow(format);
  const ImageView view = viewOf(image, format);
  if (layout == PixelFormat::kMono8 || layout == PixelFormat::kRgb8 || layout == PixelFormat::kRgba8) return image;
  const std::vector<py::ssize_t> shape{view.height_px, view.width_px, 3};
  py::array out = isDeep(format) ? py::array(py::array_t<std::uint16_t>(shape)) : py::array_t<std::uint8_t>(shape);
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
