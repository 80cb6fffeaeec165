#include "shadow_maps.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "render/opengl/scene/solid_shader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kCoarsest = 1.5;  // [texels] how far a shadow may be from where it belongs; its edge is as soft as 3

GLenum faceTarget(bool cube, int k) { return cube ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + k : GL_TEXTURE_2D; }

}  // namespace

ShadowMaps::~ShadowMaps() {
  for (Entry& entry : entries_) free(entry);
}

void ShadowMaps::free(Entry& entry) {
  if (entry.frame) gl_.DeleteFramebuffers(1, &entry.frame);
  if (entry.map.texture) gl_.DeleteTextures(1, &entry.map.texture);
  entry = Entry();
}

void ShadowMaps::update(const Scene& scene, const LightSet& lights, int side, GlStore& store) {
  ++updates_;
  maps_.assign(lights.lights.size(), nullptr);
  casters_ = castersOf(scene);
  for (Caster& caster : casters_) caster.serial = store.mesh(*caster.mesh).serial;
  // So that a place in this list means the same caster in every scene that shares a map.
  std::sort(casters_.begin(), casters_.end(), [](const Caster& a, const Caster& b) { return a.key() < b.key(); });
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    if (!lights.shades(k)) continue;
    std::vector<const Caster*> reached = reachedBy(lights.lights[k], casters_);
    const ShadowView view(lights.lights[k], reached, side);
    std::vector<double> key(view.of_world.data(), view.of_world.data() + 16);
    key.insert(key.end(), {view.near, view.far, double(view.width), double(view.height), view.cube ? 1.0 : 0.0});
    for (const Caster* caster : reached) {
      const auto own = caster->key();
      key.insert(key.end(), own.begin(), own.end());
    }
    Entry& entry = entryFor(scene, k, key);
    if (entry.key != key) {
      if (view.cube != entry.map.cube || view.width != entry.map.width || view.height != entry.map.height) free(entry);
      static_cast<ShadowView&>(entry.map) = view;
      entry.key = std::move(key);
      entry.scene = &scene;
      entry.light = k;
      entry.begun = false;
      entry.there.assign(reached.size(), 0);
      entry.boxes.clear();
      for (const Caster* caster : reached) {
        if (view.directional) entry.boxes.push_back(view.boxOf(*caster));
      }
    }
    entry.reached = std::move(reached);
    entry.used = updates_;
    maps_[k] = &entry;
  }
}

bool ShadowMaps::canShade(std::size_t k, const MapBox& box) const {
  const std::vector<MapBox>& boxes = maps_[k]->boxes;
  return std::any_of(boxes.begin(), boxes.end(), [&](const MapBox& caster) { return box.meets(caster); });
}

/** The entry with this key, else the one that this light had before, else a new one or the longest unused. */
ShadowMaps::Entry& ShadowMaps::entryFor(const Scene& scene, std::size_t light, const std::vector<double>& key) {
  Entry *own = nullptr, *oldest = nullptr;
  for (Entry& entry : entries_) {
    if (entry.key == key) return entry;
    if (entry.used == updates_) continue;  // another light has it
    if (entry.scene == &scene && entry.light == light) own = &entry;
    if (!oldest || entry.used < oldest->used) oldest = &entry;
  }
  if (own) return *own;
  if (entries_.size() < kMostKept) return entries_.emplace_back();
  return *oldest;
}

void ShadowMaps::allocate(Entry& entry) {
  Map& map = entry.map;
  const GLenum target = map.target();
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.GenTextures(1, &map.texture);
  gl_.BindTexture(target, map.texture);
  for (int k = 0; k < (map.cube ? ShadowView::kFaces : 1); ++k) {
    gl_.TexImage2D(faceTarget(map.cube, k), 0, GL_DEPTH_COMPONENT32F, map.width, map.height, 0, GL_DEPTH_COMPONENT,
                   GL_FLOAT, nullptr);
  }
  gl_.TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl_.TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // Beyond a map of parallel light there is nothing, as at its rim; beyond that of a spot there is no light.
  gl_.TexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl_.TexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl_.TexParameteri(target, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl_.TexParameteri(target, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl_.GenFramebuffers(1, &entry.frame);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, faceTarget(map.cube, 0), map.texture, 0);
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("renderer 'opengl': no shadow map of " + std::to_string(map.width) + " x " +
                      std::to_string(map.height) + " px");
  }
}

void ShadowMaps::draw(std::size_t k, const std::vector<MapBox>& boxes, GlStore& store) {
  Entry& entry = *maps_[k];
  const Map& map = entry.map;
  std::vector<char> there = entry.there;
  std::vector<const Caster*> wanted;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const auto shades = [&](const MapBox& box) { return !map.directional || box.meets(entry.boxes[i]); };
    if (there[i] || std::none_of(boxes.begin(), boxes.end(), shades)) continue;
    there[i] = 1;
    wanted.push_back(entry.reached[i]);
  }
  if (wanted.empty()) return;
  if (!entry.frame) allocate(entry);
  if (!program_) program_ = std::make_unique<ShaderProgram>(gl_, "depth", depthShader());
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.Viewport(0, 0, map.width, map.height);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_LESS);
  gl_.ClearDepth(1.0);
  program_->use();
  for (int face = 0; face < (map.cube ? ShadowView::kFaces : 1); ++face) {
    std::vector<const Caster*> shown = wanted;
    if (map.cube) {
      gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, faceTarget(true, face), map.texture, 0);
      shown.clear();
      std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(shown),
                   [&](const Caster* caster) { return map.isOnFace(face, *caster); });
    }
    if (!entry.begun) gl_.Clear(GL_DEPTH_BUFFER_BIT);
    drawSquare(map, map.cube ? map.ofFace(face) : map.of_world, shown, store);
  }
  drawn_ += !entry.begun;
  entry.begun = true;
  entry.there = std::move(there);
}

void ShadowMaps::drawSquare(const Map& map, const Eigen::Matrix4d& of_world, const std::vector<const Caster*>& casters,
                            GlStore& store) {
  const GLint projection = (*program_)["projection"];
  Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
  to_clip(0, 0) = to_clip(1, 1) = 2.0;
  to_clip(0, 3) = to_clip(1, 3) = -1.0;
  // Behind where things are by more than single precision errs by, so that what light meets straight on is lit.
  constexpr double kRounding = 1e-6, kRounding_m = 1e-5;
  to_clip(2, 3) = kRounding + (map.directional ? kRounding_m * map.of_world.row(2).head<3>().norm() : 0.0);
  for (const Caster* caster : casters) {
    const Eigen::Matrix4f P = (to_clip * of_world * caster->X_WS).cast<float>();
    gl_.UniformMatrix4fv(projection, 1, GL_FALSE, P.data());
    double texel_m = map.texel;
    if (!map.directional) texel_m *= std::max(map.near, (caster->center_W - map.light_W).norm() - caster->radius_m);
    const GlOutline outline = store.outline(*caster->mesh, kCoarsest * texel_m);
    // Of what is closed the near side hides the far one. The faces of a cube are mirrored: there both are drawn.
    if (outline.closed && !map.cube) {
      gl_.Enable(GL_CULL_FACE);
    } else {
      gl_.Disable(GL_CULL_FACE);
    }
    gl_.BindVertexArray(outline.array);
    gl_.DrawElements(GL_TRIANGLES, outline.index_count, GL_UNSIGNED_INT, nullptr);
    triangles_ += outline.index_count / 3;
  }
}

}  // namespace aras_visual_servo_sim
