#include "aras_visual_servo_sim/simulation/cameras/frame_drawer.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/image_mean.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "rolling_shutter.hpp"

namespace aras_visual_servo_sim {
namespace {

/** A scene to put things into as they were when a frame was exposed. */
Scene sceneOf(const ExposedFrame& frame, const Scene& now) { return frame.models ? frame.models->scene : now; }

}  // namespace

FrameDrawer::FrameDrawer() : coverage_(std::make_unique<CoverageRenderer>()) {}

OpenGlRenderer& FrameDrawer::openGlFor(const CameraConfig& camera) {
  const bool egl = camera.gl == "egl";
  std::shared_ptr<OpenGlRenderer>& renderer = egl ? egl_ : osmesa_;
  if (!renderer) {
    renderer = OpenGlRenderer::shared(egl ? OpenGlRenderer::Platform::kEgl : OpenGlRenderer::Platform::kOsmesa);
  }
  return *renderer;
}

std::string FrameDrawer::openGl() const {
  std::string found;
  for (const auto& renderer : {osmesa_, egl_}) {
    if (!renderer || renderer->drewWith().empty()) continue;
    found += (found.empty() ? "" : "; ") + renderer->drewWith();
  }
  return found;
}

const Image& FrameDrawer::draw(Camera& camera, std::int64_t now, const Pose& X_WC, Scene& scene) {
  if (camera.readsOut()) {
    drawOn(camera.light, camera, now, X_WC, scene);
    if (camera.seesDepth()) {
      drawGeometry(camera, X_WC, scene, Distance::kDepth, depth_);
      camera.focus(depth_);
    }
    camera.readOut(now);
  } else {
    drawOn(camera.image, camera, now, X_WC, scene);
  }
  return camera.image;
}

template <typename Value>
void FrameDrawer::drawOn(ImageOf<Value>& image, const Camera& camera, std::int64_t now, const Pose& X_WC,
                         Scene& scene) {
  if (const ExposedFrame* late = camera.takenFrame()) {
    drawLate(image, camera, *late, scene);
  } else if (camera.blurs() && camera.scheduledAt(now)) {
    const Moment present = momentOf(now, X_WC, scene);
    try {
      drawMoments(image, camera, camera.samplesOf(present), scene);
    } catch (const ArasError&) {
      show(present, scene);
      throw;
    }
    show(present, scene);
  } else {
    drawOnce(image, camera.model(), X_WC, scene);
  }
}

template <typename Value>
void FrameDrawer::drawOnce(ImageOf<Value>& image, const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  const CameraConfig& config = camera.config();
  if (config.renderer != "opengl") return coverage_->render(camera, X_WC, scene, image);
  try {
    openGlFor(config).render(camera, X_WC, scene, image);
  } catch (const RenderError& error) {
    throw RenderError("camera '" + config.name + "': " + error.what());
  }
}

/** The mean over the moments, or, of a rolling shutter, each row as it was when it was exposed. */
template <typename Value>
void FrameDrawer::drawMoments(ImageOf<Value>& image, const Camera& camera, const std::vector<Exposure::Sample>& moments,
                              Scene& scene) {
  if (!camera.rows().empty()) return drawRows(image, camera, moments, scene);
  ImageMean mean;
  for (const Exposure::Sample& sample : moments) {
    show(*sample.moment, scene);
    drawOnce(image, camera.model(), sample.moment->X_WC, scene);
    mean.add(image, sample.count);
  }
  mean.write(image);
}

template <typename Value>
void FrameDrawer::drawRows(ImageOf<Value>& image, const Camera& camera, const std::vector<Exposure::Sample>& moments,
                           Scene& scene) {
  const CameraModel& model = camera.model();
  const RollingShutter shutter(model.config(), moments, camera.periodNs());
  if (shutter.still()) {
    show(*moments.back().moment, scene);
    return drawOnce(image, model, moments.back().moment->X_WC, scene);
  }
  image.resize(model.width(), model.height(), model.drawnEncoding());
  ImageOf<Value> row;
  Moment moment;
  for (int v = 0; v < model.height(); ++v) {
    ImageMean mean;
    for (int sample = 0; sample < shutter.samples(); ++sample) {
      shutter.find(v, sample, moment);
      show(moment, scene);
      drawOnce(row, camera.rows()[v], moment.X_WC, scene);
      mean.add(row, 1);
    }
    mean.write(row);
    std::copy(row.data.begin(), row.data.end(), image.pixel(0, v));
  }
}

template <typename Value>
void FrameDrawer::drawLate(ImageOf<Value>& image, const Camera& camera, const ExposedFrame& frame, const Scene& now) {
  Scene scene = sceneOf(frame, now);
  if (frame.samples.empty()) {
    show(frame.present, scene);
    return drawOnce(image, camera.model(), frame.present.X_WC, scene);
  }
  std::vector<Exposure::Sample> moments;
  for (const auto& [moment, count] : frame.samples) moments.push_back({&moment, count});
  drawMoments(image, camera, moments, scene);
}

const GeometryImage& FrameDrawer::drawGeometry(Camera& camera, const Pose& X_WC, const Scene& now, Distance distance) {
  drawGeometry(camera, X_WC, now, distance, camera.geometry);
  return camera.geometry;
}

void FrameDrawer::drawGeometry(const Camera& camera, const Pose& X_WC, const Scene& now, Distance distance,
                               GeometryImage& out) {
  if (const ExposedFrame* late = camera.takenFrame()) {
    Scene scene = sceneOf(*late, now);
    show(late->present, scene);
    geometry_renderer_.render(camera.model(), late->present.X_WC, scene, out, distance);
  } else {
    geometry_renderer_.render(camera.model(), X_WC, now, out, distance);
  }
}

}  // namespace aras_visual_servo_sim
