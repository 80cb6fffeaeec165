#include "aras_visual_servo_sim/render/coverage_renderer.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "render/curved/curved_list.hpp"
#include "render/planar/planar_layer.hpp"
#include "render/tiles/tile_painter.hpp"
#include "render/triangles/triangle_list.hpp"

namespace aras_visual_servo_sim {
namespace {

template <typename Value>
void fill(const std::array<Value, 3>& pixel, ImageOf<Value>& image) {
  if (image.channels() == 1 || (pixel[0] == pixel[1] && pixel[1] == pixel[2])) {
    std::fill(image.data.begin(), image.data.end(), pixel[0]);
    return;
  }
  for (int u = 0; u < image.width; ++u) std::copy_n(pixel.data(), 3, image.pixel(u, 0));
  for (int v = 1; v < image.height; ++v) std::copy_n(image.pixel(0, 0), image.stride(), image.pixel(0, v));
}

void addShape(const Shape& shape, const std::string& body, Undrawn& undrawn) {
  const Material &material = shape.material, usual;
  const auto add = [&](bool there, const char* part) {
    if (there) undrawn[part].insert(body);
  };
  add(material.ambient || material.ambient_share != usual.ambient_share, "ambient colour");
  add(material.specular != usual.specular, "specular");
  add(material.emissive != usual.emissive, "emissive");
  add(material.unlit, "the evenness of unlit surfaces");
  add(material.opacity != usual.opacity, "opacity");
  add(material.two_sided != usual.two_sided, "the back of two-sided faces");
  const std::vector<MeshPicture>& pictures = shape.mesh->pictures;
  add(std::any_of(pictures.begin(), pictures.end(), [](const MeshPicture& each) { return each.normals != nullptr; }),
      "normal map");
}

}  // namespace

class CoverageRenderer::Implementation {
 public:
  explicit Implementation(Path path) : path_(path) {}

  template <typename Value>
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, ImageOf<Value>& out) {
    statistics_ = {};
    draw(camera, X_WC, scene, out);
    if (camera.showsLensCircle()) blackenBeyondLens(camera, rasterizer_, out);
  }

  Statistics statistics_;

 private:
  template <typename Value>
  void draw(const CameraModel& camera, const Pose& X_WC, const Scene& scene, ImageOf<Value>& out) {
    const ViewVolume volume(camera);
    planar_.project(camera, volume, X_WC.inverse(), scene);
    fill(pixelOf<Value>(scene.background, out.encoding), out);
    const bool everything = path_ == Path::kSampled;
    planar_.samplePictures<Value>(camera, rasterizer_);
    if (!everything) planar_.paint(camera, rasterizer_, out);
    triangles_.begin(camera, volume);
    curved_.begin(camera, volume);
    const bool bodies_in_view = triangles_.addBodies(scene, X_WC.inverse());
    const bool curved_in_view = curved_.addBodies(scene, X_WC.inverse());
    if (!everything && !bodies_in_view && !curved_in_view && planar_.conflicts().empty()) return;

    bins_.begin(out.width, out.height);
    if (everything) bins_.markEverything();
    for (const PixelBox& box : planar_.conflicts()) bins_.markEverything(box);
    bins_.markBodies(triangles_);
    for (int tile = 0; tile < curved_.tiles(); ++tile) {
      if (curved_.begin(tile) != curved_.end(tile)) bins_.markBody(tile);
    }
    triangles_.addPlanar(planar_, X_WC.inverse());
    bins_.sort(triangles_);
    tiles_.paint(camera, triangles_, curved_, bins_, scene.background,
                 TilePainter::Canvas<Value>{&out, &planar_.pictures<Value>()});
    statistics_ = {static_cast<int>(triangles_.size()), tiles_.statistics().tiles, tiles_.statistics().sampled_pixels};
  }

  Path path_;
  PlanarLayer planar_;
  CoverageRasterizer rasterizer_;
  TriangleList triangles_;
  CurvedList curved_;
  TileBins bins_;
  TilePainter tiles_;
};

CoverageRenderer::CoverageRenderer(Path path) : implementation_(std::make_unique<Implementation>(path)) {}
CoverageRenderer::~CoverageRenderer() = default;
CoverageRenderer::CoverageRenderer(CoverageRenderer&&) noexcept = default;
CoverageRenderer& CoverageRenderer::operator=(CoverageRenderer&&) noexcept = default;

const CoverageRenderer::Statistics& CoverageRenderer::statistics() const { return implementation_->statistics_; }

void CoverageRenderer::doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) {
  std::visit([&](auto* image) { implementation_->render(camera, X_WC, scene, *image); }, out);
}

Undrawn undrawnByCoverage(const Scene& scene) {
  Undrawn undrawn;
  for (const Body& body : scene.bodies) {
    for (const Shape& shape : body.shapes) addShape(shape, body.name, undrawn);
  }
  const Lighting& lighting = scene.lighting;
  for (const Light& light : lighting.lights) {
    undrawn["light"].insert(light.name);
    if (lighting.shadows && light.casts_shadows) undrawn["shadows"].insert(light.name);
  }
  if (lighting.fog) undrawn["fog"].insert("");
  if (lighting.zenith) undrawn["sky"].insert("");
  return undrawn;
}

std::string textOf(const Undrawn& undrawn) {
  std::string text;
  for (const auto& [part, names] : undrawn) {
    text += (text.empty() ? "" : "; ") + part;
    const char* before = " of ";
    for (const std::string& name : names) {
      if (name.empty()) continue;
      text += before + name;
      before = ", ";
    }
  }
  return text;
}

}  // namespace aras_visual_servo_sim
