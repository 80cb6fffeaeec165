#include "aras_visual_servo_sim/render/opengl_renderer.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <list>
#include <map>
#include <mutex>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/wide.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "render/opengl/camera_views.hpp"
#include "render/opengl/gl/gl_context.hpp"
#include "render/opengl/gl/packed_pixel.hpp"
#include "render/opengl/scene/flat_painter.hpp"
#include "render/opengl/scene/solid_painter.hpp"
#include "render/planar/planar_layer.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Whatever decides how a camera's image is made of pictures. */
std::vector<double> keyOf(const CameraModel& camera, bool fine) {
  std::vector<double> key{fine ? 1.0 : 0.0,
                          double(camera.width()),
                          double(camera.height()),
                          camera.fx(),
                          camera.fy(),
                          camera.cx(),
                          camera.cy(),
                          double(static_cast<int>(camera.lens())),
                          double(static_cast<int>(camera.sampling())),
                          camera.config().quality == "high" ? 1.0 : 0.0,
                          camera.showsLensCircle() ? camera.lensAngle() : 0.0};
  const std::vector<double>& lens = camera.config().distortion;
  key.insert(key.end(), lens.begin(), lens.end());
  return key;
}

template <typename Pixel, typename Value>
void write(Pixel pixel, Encoding encoding, Value* out) {
  static_assert(Packed<Pixel>::kBits == 8 * sizeof(Value));
  const auto part = [pixel](int k) { return static_cast<Value>(Packed<Pixel>::channel(pixel, k)); };
  if (encoding == Encoding::kMono8) {
    *out = static_cast<Value>(luma(part(0), part(1), part(2)) + 0.5);
    return;
  }
  out[0] = part(encoding == Encoding::kRgb8 ? 0 : 2);
  out[1] = part(1);
  out[2] = part(encoding == Encoding::kRgb8 ? 2 : 0);
}

#if defined(__GNUC__) && !defined(__clang__)
using Bytes16 = std::uint8_t __attribute__((vector_size(16)));

/** Drops alpha and may swap r and b, four pixels at a time. @return how many pixels it did */
ARAS_WIDE std::size_t dropAlpha(const std::uint32_t* pixels, std::size_t count, bool swap, std::uint8_t* to) {
  const Bytes16 straight = {0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 0, 0, 0, 0};
  const Bytes16 swapped = {2, 1, 0, 6, 5, 4, 10, 9, 8, 14, 13, 12, 0, 0, 0, 0};
  const Bytes16 order = swap ? swapped : straight;
  std::size_t k = 0;
  for (; k + 6 <= count; k += 4, to += 12) {
    Bytes16 four;
    std::memcpy(&four, pixels + k, sizeof(four));
    four = __builtin_shuffle(four, order);
    std::memcpy(to, &four, sizeof(four));
  }
  return k;
}
#else
std::size_t dropAlpha(const std::uint32_t*, std::size_t, bool, std::uint8_t*) { return 0; }
#endif

ARAS_WIDE void toGrey(const std::uint32_t* pixels, std::size_t count, std::uint8_t* to) {
  for (std::size_t k = 0; k < count; ++k) {
    const auto r = static_cast<int>(pixels[k] & 255), g = static_cast<int>((pixels[k] >> 8) & 255);
    const auto b = static_cast<int>((pixels[k] >> 16) & 255);
    to[k] = static_cast<std::uint8_t>(static_cast<int>(luma(r, g, b) + 0.5));
  }
}

template <typename Value>
void convert(const std::vector<PixelFor<Value>>& pixels, ImageOf<Value>& out) {
  const int channels = out.channels();
  Value* to = out.data.data();
  std::size_t done = 0;
  if constexpr (std::is_same_v<Value, std::uint8_t>) {
    if (out.encoding == Encoding::kMono8) return toGrey(pixels.data(), pixels.size(), to);
    done = dropAlpha(pixels.data(), pixels.size(), out.encoding == Encoding::kBgr8, to);
  }
  for (std::size_t k = done; k < pixels.size(); ++k) write(pixels[k], out.encoding, to + k * channels);
}

}  // namespace

class OpenGlRenderer::Implementation {
 public:
  explicit Implementation(MakeContext make_context) : make_context_(std::move(make_context)) {}

  ~Implementation() { forget(); }

  std::string description() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const GlContext::Binding binding = bind();
    return context_->description();
  }

  template <typename Value>
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, ImageOf<Value>& out) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const GlContext::Binding binding = bind();
    if (!parts_) {
      parts_ = std::make_unique<Parts>(context_->gl());
      drew_with_ = context_->description();
    }
    prepare();
    draw(camera, X_WC, scene, out);
    context_->gl().check("drawing");
    if (ShaderProgram::made() != shaders_) giveBackCompilerMemory();
    shaders_ = ShaderProgram::made();
    if (camera.showsLensCircle()) blackenBeyondLens(camera, rasterizer_, out);
  }

  std::string drewWith() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return drew_with_;
  }

  Statistics statistics_;

 private:
  static constexpr std::size_t kMostCameras = 16 + 4096;  // whose pictures are kept; rows of rolling shutters are some

  struct Parts {
    explicit Parts(const GlFunctions& gl) : store(gl), solids(gl, store), flats(gl, store) {}
    GlStore store;
    SolidPainter solids;
    FlatPainter flats;
    std::list<std::pair<std::vector<double>, CameraViews>> views;  // by keyOf, used last first
    std::map<std::vector<double>, decltype(views)::iterator> views_of;
  };

  GlContext::Binding bind() {
    if (!context_) context_ = make_context_();
    try {
      return GlContext::Binding(*context_);
    } catch (const RenderError&) {
      abandon();
      throw;
    }
  }

  /** The context is lost, and all that was in it: none of it can be freed. */
  void abandon() {
    (void)parts_.release();
    (void)context_.release();
  }

  void forget() {
    if (!parts_) return;
    try {
      const GlContext::Binding binding(*context_);
      parts_.reset();
    } catch (const ArasError&) {
      abandon();
    }
  }

  CameraViews& viewsOf(const CameraModel& camera, bool fine) {
    auto& all = parts_->views;
    const std::vector<double> key = keyOf(camera, fine);
    const auto found = parts_->views_of.find(key);
    if (found != parts_->views_of.end()) {
      all.splice(all.begin(), all, found->second);
    } else {
      all.emplace_front(std::piecewise_construct, std::forward_as_tuple(key),
                        std::forward_as_tuple(context_->gl(), camera, fine));
      parts_->views_of[key] = all.begin();
      if (all.size() > kMostCameras) {
        parts_->views_of.erase(all.back().first);
        all.pop_back();
      }
    }
    return all.front().second;
  }

  void prepare() {
    const GlFunctions& gl = context_->gl();
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl.FrontFace(GL_CW);  // counter-clockwise in the world, and rows grow downwards
    gl.CullFace(GL_BACK);
    gl.Enable(GL_DEPTH_TEST);
    gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    gl.Disable(GL_DITHER);
    parts_->store.clean();
  }

  void clear(const PixelBox& part, const Rgb& color) {
    const GlFunctions& gl = context_->gl();
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(part.u0, part.v0, part.u1 - part.u0, part.v1 - part.v0);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.DepthMask(GL_TRUE);
    gl.ClearColor(color.r / 255.0f, color.g / 255.0f, color.b / 255.0f, 0.0f);
    gl.ClearDepth(0.0);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl.Disable(GL_SCISSOR_TEST);
  }

  template <typename Value>
  void draw(const CameraModel& camera, const Pose& X_WC, const Scene& scene, ImageOf<Value>& out) {
    const Pose X_CW = X_WC.inverse();
    planar_.project(camera, ViewVolume(camera), X_CW, scene);
    SolidPainter& solids = parts_->solids;
    FlatPainter& flats = parts_->flats;
    CameraViews& views = viewsOf(camera, sizeof(Value) > 1);
    solids.begin(camera, X_WC, scene, views.views(), std::numeric_limits<Value>::max());
    flats.begin(planar_, X_CW, camera.nearM());
    const bool exact = camera.config().exact_targets && !solids.anyTransparent() && !flats.empty();
    auto& pixels = std::get<std::vector<PixelFor<Value>>>(pixels_);
    long sampled_px = 0;
    if (flats.empty()) {
      for (std::size_t k = 0; k < views.views().size(); ++k) {
        sampled_px += drawInParts(scene, views, k, views.picture(k, pixels));
      }
      views.compose(pixels);
    } else {
      for (std::size_t k = 0; k < views.views().size(); ++k) {
        const PinholeView& view = views.views()[k];
        const PixelBox all{0, 0, view.width, view.height};
        views.canvas(k).bind();
        clear(all, scene.background);
        solids.drawIn(all);
        solids.drawSky(view);
        solids.drawOpaque(k);
        if (exact) {
          flats.mark(view);
        } else {
          flats.draw(view);
          solids.drawTransparent(k);
        }
        sampled_px += static_cast<long>(all.area());
      }
      views.read(pixels);
    }
    convert(pixels, out);
    statistics_ = {static_cast<int>(views.views().size()), sampled_px, false, solids.shadows().drawn(),
                   solids.shadows().triangles()};
    if (exact) layTargetsOver(camera, views, out);
  }

  /** Bodies and sky of picture k, several samples only where they can differ. @return how many pixels have several */
  template <typename Pixel>
  long drawInParts(const Scene& scene, CameraViews& views, std::size_t k, std::vector<Pixel>& pixels) {
    SolidPainter& solids = parts_->solids;
    const PinholeView& view = views.views()[k];
    const SolidPainter::Plan plan = solids.planOf(k);
    if (plan.sky || plan.backdrop) {
      const PixelBox all{0, 0, view.width, view.height};
      views.singleSampled(k).bind();
      clear(all, scene.background);
      solids.drawIn(all, plan.sampled);
      solids.drawSky(view);
      if (plan.backdrop) solids.drawBackdrop(k, *plan.backdrop);
      views.singleSampled(k).read(pixels);
    } else {
      const Rgb& color = scene.background;
      pixels.assign(std::size_t(view.width) * view.height, Packed<Pixel>::of(color.r, color.g, color.b));
    }
    const Canvas& canvas = views.canvas(k);
    canvas.bind();
    long sampled_px = 0;
    for (const auto& part : plan.sampled) {
      if (!part.filled) clear(part, scene.background);
      solids.drawIn(part);
      if (!part.filled) solids.drawSky(view);
      solids.drawOpaque(k, part.filled ? plan.backdrop : std::nullopt);
      solids.drawTransparent(k);
      sampled_px += static_cast<long>(part.area());
    }
    for (const auto& part : plan.sampled) canvas.read(part, pixels);
    return sampled_px;
  }

  /** Flat targets by their exact coverage; where a solid stands before one, or two of them cut each other, as OpenGL
   *  draws them. */
  template <typename Value>
  void layTargetsOver(const CameraModel& camera, CameraViews& views, ImageOf<Value>& out) {
    planar_.samplePictures<Value>(camera, rasterizer_);
    planar_.paint(camera, rasterizer_, out);
    redrawn_.clear();
    auto& pixels = std::get<std::vector<PixelFor<Value>>>(pixels_);
    findHidden(pixels, out.width, out.height);
    for (const PixelBox& box : planar_.conflicts()) {
      for (int v = box.v0; v < box.v1; ++v) {
        for (int u = box.u0; u < box.u1; ++u) redrawn_.push_back(std::size_t(v) * out.width + u);
      }
    }
    if (redrawn_.empty()) return;
    statistics_.redrawn_flats = true;
    for (std::size_t k = 0; k < views.views().size(); ++k) {
      views.canvas(k).bind();
      parts_->flats.draw(views.views()[k]);
    }
    views.read(boxOf(redrawn_, out.width), pixels);
    for (const std::size_t at : redrawn_) {
      write(pixels[at], out.encoding, out.data.data() + at * std::size_t(out.channels()));
    }
  }

  /** The smallest box about these pixels, of which there are some. */
  static PixelBox boxOf(const std::vector<std::size_t>& pixels, int width) {
    PixelBox box;
    for (const std::size_t at : pixels) {
      const int u = static_cast<int>(at % std::size_t(width)), v = static_cast<int>(at / std::size_t(width));
      box = box.with({u, v, u + 1, v + 1});
    }
    return box;
  }

  /** The pixels that have a mark, and their neighbours: a mark at a sample says nothing of the pixel's rim. */
  template <typename Pixel>
  void findHidden(const std::vector<Pixel>& pixels, int width, int height) {
    constexpr Pixel kMarked = (Packed<Pixel>::kMost + 509) / 510;  // half a grey level
    hidden_.assign(pixels.size(), 0);
    bool any = false;
    for (int v = 0; v < height; ++v) {
      const Pixel* row = pixels.data() + std::size_t(v) * width;
      for (int u = 0; u < width; ++u) {
        if (Packed<Pixel>::alpha(row[u]) < kMarked) continue;
        any = true;
        for (int y = std::max(0, v - 1); y <= std::min(height - 1, v + 1); ++y) {
          for (int x = std::max(0, u - 1); x <= std::min(width - 1, u + 1); ++x) {
            hidden_[std::size_t(y) * width + x] = 1;
          }
        }
      }
    }
    for (std::size_t k = 0; any && k < hidden_.size(); ++k) {
      if (hidden_[k]) redrawn_.push_back(k);
    }
  }

  mutable std::mutex mutex_;  // held while it draws
  MakeContext make_context_;
  std::string drew_with_;
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<Parts> parts_;
  PlanarLayer planar_;
  CoverageRasterizer rasterizer_;
  long shaders_ = 0;                                                           // made when the last image was done
  std::tuple<std::vector<std::uint32_t>, std::vector<std::uint64_t>> pixels_;  // as they were read
  std::vector<char> hidden_;
  std::vector<std::size_t> redrawn_;
};

OpenGlRenderer::OpenGlRenderer(Platform platform)
    : OpenGlRenderer(platform == Platform::kEgl ? &makeEglContext : &makeOsmesaContext) {}

OpenGlRenderer::OpenGlRenderer(MakeContext make_context)
    : implementation_(std::make_unique<Implementation>(std::move(make_context))) {}

OpenGlRenderer::~OpenGlRenderer() = default;

std::string OpenGlRenderer::description() { return implementation_->description(); }

std::shared_ptr<OpenGlRenderer> OpenGlRenderer::shared(Platform platform) {
  thread_local std::weak_ptr<OpenGlRenderer> of_thread[2];
  std::weak_ptr<OpenGlRenderer>& known = of_thread[platform == Platform::kEgl ? 1 : 0];
  std::shared_ptr<OpenGlRenderer> renderer = known.lock();
  if (!renderer) known = renderer = std::make_shared<OpenGlRenderer>(platform);
  return renderer;
}

std::string OpenGlRenderer::drewWith() const { return implementation_->drewWith(); }

const OpenGlRenderer::Statistics& OpenGlRenderer::statistics() const { return implementation_->statistics_; }

void OpenGlRenderer::doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) {
  std::visit([&](auto* image) { implementation_->render(camera, X_WC, scene, *image); }, out);
}

}  // namespace aras_visual_servo_sim
