#pragma once

#include <functional>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/render/renderer.hpp"

namespace aras_visual_servo_sim {

class GlContext;

/** Renderer with lights, shadows, materials and pictures, by OpenGL 3.3 without a window.
 *
 *  Solids are drawn by OpenGL, with four samples a pixel. Flat targets are laid over them with the exact coverage of
 *  CoverageRenderer, wherever no solid stands before them (CameraConfig::exact_targets). Images are the same between
 *  runs, processes and threads on one kind of processor and one version of Mesa. The library is opened at the first
 *  frame. A context that was lost costs one image, an error; the next one is drawn in a new context. Frames may be
 * drawn from several threads, one after the other; one object may serve many cameras of many scenes. */
class OpenGlRenderer : public Renderer {
 public:
  enum class Platform {
    kOsmesa,  ///< Mesa's software renderer
    kEgl      ///< a GPU where there is one
  };

  using MakeContext = std::function<std::unique_ptr<GlContext>()>;

  explicit OpenGlRenderer(Platform platform = Platform::kOsmesa);
  /** Draws in contexts made elsewhere. */
  explicit OpenGlRenderer(MakeContext make_context);
  ~OpenGlRenderer() override;

  /** The one that all simulations of the calling thread share: made for the first of them, gone with the last. */
  static std::shared_ptr<OpenGlRenderer> shared(Platform platform);

  /** What draws and of which version. @throws RenderError if there is no OpenGL */
  std::string description();
  /** The same, empty before the first image. */
  std::string drewWith() const;

  /** What the last frame took, and all so far: to test and to measure. */
  struct Statistics {
    int views = 0;               ///< pictures that the last image was made of
    long sampled_px = 0;         ///< of them, those that were drawn with as many samples as the camera takes
    bool redrawn_flats = false;  ///< a solid stood before a flat target, so that OpenGL drew targets too
    long shadow_maps = 0;        ///< begun so far
    long shadow_triangles = 0;   ///< drawn into them so far
  };
  const Statistics& statistics() const;

 private:
  void doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) override;

  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace aras_visual_servo_sim
