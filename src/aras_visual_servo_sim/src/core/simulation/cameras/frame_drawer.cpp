#include "aras_visual_servo_sim/simulation/cameras/frame_drawer.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/image_mean.hpp"
#include "aras_visual_servo_sim/render/coverage_renderer.hpp"

namespace aras_visual_servo_sim {
namespace {

/** A scene to put things into as they were when a frame was exposed. */
Scene sceneOf(const ExposedFrame& frame, const Scene& now) { return frame.models ? frame.models->scene : now; }

}  // namespace

FrameDrawer::FrameDrawer() : coverage_(std::make_unique<CoverageRenderer>()) {}

OpenGlRenderer& FrameDrawer::openGlFor(const CameraConfig& camera) {
  const bool egl = camera.gl == "egl";
  std::unique_ptr<OpenGlRenderer>& renderer = egl ? egl_ : osmesa_;
  if (!renderer) {
    renderer =
        std::make_unique<OpenGlRenderer>(egl ? OpenGlRenderer::Platform::kEgl : OpenGlRenderer::Platform::kOsmesa);
  }
  return *renderer;
}

std::string FrameDrawer::openGl() const {
  std::string found;
  for (const OpenGlRenderer* renderer : {osmesa_.get(), egl_.get()}) {
    if (!renderer || renderer->drewWith().empty()) continue;
    found += (found.empty() ? "" : "; ") + renderer->drewWith();
  }
  return found;
}

const Image& FrameDrawer::draw(Camera& camera, std::int64_t now, const Pose& X_WC, Scene& scene) {
  if (camera.noisy()) {
    drawOn(camera.light, camera, now, X_WC, scene);
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
    drawMean(image, camera, momentOf(now, X_WC, scene), scene);
  } else {
    drawOnce(image, camera, X_WC, scene);
  }
}

template <typename Value>
void FrameDrawer::drawOnce(ImageOf<Value>& image, const Camera& camera, const Pose& X_WC, const Scene& scene) {
  const CameraConfig& config = camera.model().config();
  if (config.renderer != "opengl") return coverage_->render(camera.model(), X_WC, scene, image);
  try {
    openGlFor(config).render(camera.model(), X_WC, scene, image);
  } catch (const RenderError& error) {
    throw RenderError("camera '" + config.name + "': " + error.what());
  }
}

template <typename Value>
void FrameDrawer::drawMean(ImageOf<Value>& image, const Camera& camera, const Moment& present, Scene& scene) {
  ImageMean mean;
  try {
    for (const Exposure::Sample& sample : camera.samplesOf(present)) {
      show(*sample.moment, scene);
      drawOnce(image, camera, sample.moment->X_WC, scene);
      mean.add(image, sample.count);
    }
  } catch (const ArasError&) {
    show(present, scene);
    throw;
  }
  show(present, scene);
  mean.write(image);
}

template <typename Value>
void FrameDrawer::drawLate(ImageOf<Value>& image, const Camera& camera, const ExposedFrame& frame, const Scene& now) {
  Scene scene = sceneOf(frame, now);
  const auto drawAt = [&](const Moment& moment) {
    show(moment, scene);
    drawOnce(image, camera, moment.X_WC, scene);
  };
  if (frame.samples.empty()) return drawAt(frame.present);
  ImageMean mean;
  for (const auto& [moment, count] : frame.samples) {
    drawAt(moment);
    mean.add(image, count);
  }
  mean.write(image);
}

const GeometryImage& FrameDrawer::drawGeometry(Camera& camera, const Pose& X_WC, const Scene& now, Distance distance) {
  if (const ExposedFrame* late = camera.takenFrame()) {
    Scene scene = sceneOf(*late, now);
    show(late->present, scene);
    geometry_renderer_.render(camera.model(), late->present.X_WC, scene, camera.geometry, distance);
  } else {
    geometry_renderer_.render(camera.model(), X_WC, now, camera.geometry, distance);
  }
  return camera.geometry;
}

}  // namespace aras_visual_servo_sim
