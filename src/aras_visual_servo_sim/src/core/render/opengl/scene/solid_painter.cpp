#include "solid_painter.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "backdrop.hpp"
#include "picture_taps.hpp"

namespace aras_visual_servo_sim {
namespace {

Eigen::Vector3f unit(const Rgb& color) { return Eigen::Vector3f(color.r, color.g, color.b) / 255.0f; }

constexpr int kFirstMapUnit = 1;  // unit 0 has the picture
constexpr int kBumpsUnit = kFirstMapUnit + LightSet::kMostShadows;
constexpr float kUnmarked = 0.0f;  // alpha of what no mark of FlatPainter lies on

}  // namespace

SolidPainter::~SolidPainter() {
  if (sky_array_) gl_.DeleteVertexArrays(1, &sky_array_);
  if (sky_vertices_) gl_.DeleteBuffers(1, &sky_vertices_);
}

void SolidPainter::begin(const CameraModel& camera, const Pose& X_WC, const Scene& scene,
                         const std::vector<PinholeView>& views, int levels) {
  ++frame_;
  camera_ = &camera;
  scene_ = &scene;
  X_WC_ = X_WC;
  lights_ = std::make_unique<LightSet>(scene);
  letters_ = lights_->letters();
  most_highlight_.setZero();
  for (const Light& light : lights_->lights) most_highlight_ += light.specular;
  least_highlight_ = 0.5 / levels;
  opaque_.clear();
  transparent_.clear();
  const Pose X_CW = X_WC.inverse();
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    const Pose X_CB = X_CW * body.X_WB;
    for (const Shape& shape : body.shapes) {
      const Pose X_CS = X_CB * shape.X_BS;
      (shape.material.opacity < 1.0 ? transparent_ : opaque_)
          .push_back({&shape, X_CS.matrix(), X_CS * shape.mesh->center(), shape.mesh->radius()});
    }
  }
  std::stable_sort(transparent_.begin(), transparent_.end(),
                   [](const Item& a, const Item& b) { return a.center_C.norm() > b.center_C.norm(); });
  gl_.Disable(GL_BLEND);
  shadows_.update(scene, *lights_, scene.lighting.shadow_map_px, store_);
  shaded_.assign(lights_->lights.size(), {});
  seen_.clear();
  for (const PinholeView& view : views) {
    seen_.push_back({&view, sightsOf(opaque_, view), sightsOf(transparent_, view)});
  }
  for (std::size_t k = 0; k < shaded_.size(); ++k) {
    if (lights_->shades(k)) shadows_.draw(k, shaded_[k], store_);
  }
}

std::vector<SolidPainter::Sight> SolidPainter::sightsOf(const std::vector<Item>& items, const PinholeView& view) {
  std::vector<Sight> sights;
  const Eigen::Matrix4d X_WC = X_WC_.matrix();
  for (const Item& item : items) {
    if (!isSeen(item, view)) continue;
    Sight sight{&item, coveredPart(*item.shape->mesh, item.X_CS, view, camera_->nearM()), letters_, nullptr};
    if (sight.covered.empty()) continue;
    for (std::size_t k = 0; k < letters_.size(); ++k) {
      if (!std::isupper(letters_[k])) continue;
      MapBox box;
      if (letters_[k] == 'D') {
        box = SeenMesh(*item.shape->mesh, item.X_CS, shadows_.map(k).of_world * X_WC, view).box();
        if (box.empty() || !shadows_.canShade(k, box)) {
          sight.letters[k] = 'd';
          continue;
        }
      }
      shaded_[k].push_back(box);
    }
    sight.mesh = &store_.meshSeen(item.shape->mesh, scaleOf(item, view));
    sights.push_back(std::move(sight));
  }
  return sights;
}

std::optional<std::size_t> SolidPainter::backdropOf(const Seen& seen) const {
  constexpr double kMuch = 0.25;  // of the picture
  std::optional<std::size_t> largest;
  double most = kMuch * seen.view->width * seen.view->height;
  for (std::size_t k = 0; k < seen.opaque.size(); ++k) {
    const Shape& shape = *seen.opaque[k].item->shape;
    if (seen.opaque[k].covered.area() <= most || shape.material.two_sided || !canBeBackdrop(*shape.mesh)) continue;
    most = seen.opaque[k].covered.area();
    largest = k;
  }
  return largest;
}

bool SolidPainter::isFilled(const Seen& seen, std::size_t backdrop, const PixelBox& part) const {
  const Item& item = *seen.opaque[backdrop].item;
  return fills(*item.shape->mesh, item.X_CS, *seen.view, camera_->nearM(), camera_->farM(), part);
}

SolidPainter::Plan SolidPainter::planOf(std::size_t view) const {
  constexpr double kWorthwhile = 0.7;      // of the pixels: beyond that, drawing the rest another way saves nothing
  constexpr double kTrianglePixels = 4.0;  // a triangle drawn once more takes as long as so many pixels
  const Seen& seen = seen_[view];
  const PixelBox all{0, 0, seen.view->width, seen.view->height};
  Plan plan;
  plan.sky = scene_->lighting.zenith.has_value();
  plan.backdrop = backdropOf(seen);
  PixelParts parts(all);
  PixelBox covered;
  for (const std::vector<Sight>* sights : {&seen.opaque, &seen.transparent}) {
    for (const Sight& sight : *sights) {
      covered = covered.with(sight.covered);
      const bool smooth = plan.backdrop && &sight == &seen.opaque[*plan.backdrop];
      if (!smooth) parts.add(sight.covered);
    }
  }
  if (plan.backdrop) {
    const Item& item = *seen.opaque[*plan.backdrop].item;
    addEdges(*item.shape->mesh, item.X_CS, *seen.view, camera_->nearM(), camera_->farM(), parts);
  }
  for (const std::vector<Sight>* sights : {&seen.opaque, &seen.transparent}) {
    for (const Sight& sight : *sights) {
      parts.join(sight.covered, kTrianglePixels * sight.mesh->index_count / 3);
    }
  }
  if (plan.sky || plan.backdrop) covered = all;
  if (parts.area() > kWorthwhile * covered.area()) return {{{covered}}, false, std::nullopt};
  for (const PixelBox& part : parts.parts()) {
    plan.sampled.push_back({part, plan.backdrop && isFilled(seen, *plan.backdrop, part)});
  }
  return plan;
}

/** Whether the eye is in the midst of a solid, all of whose faces look away. */
bool SolidPainter::isAroundEye(const Item& item) const {
  constexpr std::size_t kFew = 64;  // triangles: others would take a long look
  const TriangleMesh& mesh = *item.shape->mesh;
  if (item.shape->material.two_sided || mesh.round || mesh.triangles.size() > kFew) return false;
  if (item.center_C.norm() > item.radius) return false;
  const Eigen::Vector3d eye_S = item.X_CS.inverse().topRightCorner<3, 1>();
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const Eigen::Vector3d p = mesh.points[t[0]].template cast<double>();
    const Eigen::Vector3d a = mesh.points[t[1]].template cast<double>() - p;
    const Eigen::Vector3d b = mesh.points[t[2]].template cast<double>() - p;
    constexpr double kRounding_m = 1e-6;
    const Eigen::Vector3d n = a.cross(b);
    return n.dot(eye_S - p) < -kRounding_m * n.norm();
  });
}

bool SolidPainter::isSeen(const Item& item, const PinholeView& view) const {
  const Eigen::Vector3d p = view.R_FC * item.center_C;
  if (p.z() + item.radius < camera_->nearM() || p.z() - item.radius > camera_->farM()) return false;
  const auto [left, right, top, bottom] = view.border(0.5);
  const auto outside = [&](double across, double slope, double side) {
    return side * (across - slope * p.z()) > item.radius * std::sqrt(1.0 + slope * slope);
  };
  return !outside(p.x(), left, -1.0) && !outside(p.x(), right, 1.0) && !outside(p.y(), top, -1.0) &&
         !outside(p.y(), bottom, 1.0) && !isAroundEye(item);
}

void SolidPainter::prepareOpaque() {
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_GEQUAL);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void SolidPainter::drawOpaque(std::size_t view, std::optional<std::size_t> filled) {
  const Seen& seen = seen_[view];
  prepareOpaque();
  if (filled) {
    gl_.DepthFunc(GL_ALWAYS);
    draw(seen.opaque[*filled], *seen.view);
    gl_.DepthFunc(GL_GEQUAL);
  }
  for (std::size_t k = 0; k < seen.opaque.size(); ++k) {
    if (k != filled) draw(seen.opaque[k], *seen.view);
  }
}

void SolidPainter::drawBackdrop(std::size_t view, std::size_t place) {
  prepareOpaque();
  draw(seen_[view].opaque[place], *seen_[view].view);
}

void SolidPainter::drawTransparent(std::size_t view) {
  if (seen_[view].transparent.empty()) return;
  gl_.DepthMask(GL_FALSE);
  gl_.DepthFunc(GL_GEQUAL);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (const Sight& sight : seen_[view].transparent) draw(sight, *seen_[view].view);
  gl_.Disable(GL_BLEND);
  gl_.DepthMask(GL_TRUE);
}

void SolidPainter::addShadowed(const Item& item, std::size_t k, const PinholeView& view, PixelParts& parts) const {
  const SeenMesh seen(*item.shape->mesh, item.X_CS, shadows_.map(k).of_world * X_WC_.matrix(), view);
  for (const MapBox& caster : shadows_.boxes(k)) {
    if (seen.box().meets(caster)) parts.add(seen.shadowOf(caster, camera_->nearM()));
  }
}

/** How many pixels a metre of a body has at most in a picture [px/m]. */
double SolidPainter::scaleOf(const Item& item, const PinholeView& view) const {
  // A body beside the axis is drawn larger, by as much as it is farther away than its depth.
  const double depth = std::max(view.R_FC.row(2).dot(item.center_C) - item.radius, camera_->nearM());
  double slope = std::max(1.0, item.center_C.norm() / depth) / depth;
  if (!item.shape->mesh->round) {  // the ball about a mesh may hold the eye where its box is far
    const Eigen::Vector3d eye_S = item.X_CS.inverse().topRightCorner<3, 1>();
    const TriangleMesh& mesh = *item.shape->mesh;
    const Eigen::Vector3d low = mesh.box_min.cast<double>(), high = mesh.box_max.cast<double>();
    const double away = std::max((eye_S - eye_S.cwiseMax(low).cwiseMin(high)).norm(), camera_->nearM());
    const auto [left, right, top, bottom] = view.border(0.0);
    const double across = std::max(-left, right), down = std::max(-top, bottom);
    slope = std::min(slope, (1.0 + across * across + down * down) / away);
  }
  return std::max(view.fx, view.fy) * slope;
}

void SolidPainter::draw(const Sight& sight, const PinholeView& view) {
  const PixelBox all = sight.covered.within(limit_);
  if (all.empty()) return;
  const Item& item = *sight.item;
  const Shape& shape = *item.shape;
  const Eigen::RowVector3d axis = view.R_FC.row(2);
  const GlMesh& mesh = *sight.mesh;
  gl_.BindVertexArray(mesh.array);
  if (shape.material.two_sided) {
    gl_.Disable(GL_CULL_FACE);
  } else {
    gl_.Enable(GL_CULL_FACE);
  }
  const bool reaches_far = axis.dot(item.center_C) + item.radius > camera_->farM();
  if (reaches_far) gl_.Enable(GL_CLIP_DISTANCE0);
  constexpr GLsizei kFew = 3 * 1000;  // indices: drawing their points again costs less than shadows all over
  constexpr double kSmallPart = 0.7;  // of the pixels
  const bool few = mesh.index_count <= kFew;
  std::string shaded = shape.material.unlit ? std::string() : sight.letters, plain = shaded;
  PixelParts parts(all);
  for (std::size_t k = 0; k < shaded.size(); ++k) {
    if (!std::isupper(shaded[k])) continue;
    plain[k] = static_cast<char>(std::tolower(shaded[k]));
    if (!shadows_.begun(k)) {
      shaded[k] = plain[k];
    } else if (few && shaded[k] == 'D') {
      addShadowed(item, k, view, parts);
    } else {
      parts.add(all);
    }
  }
  gl_.Enable(GL_SCISSOR_TEST);
  const auto drawIn = [&](const PixelBox& where, const std::string& letters) {
    if (!where.empty()) draw(item, view, mesh, letters, where, few);
  };
  // What is drawn again with its shadows replaces what was there: its depth is the same. What lets light through is
  // drawn once.
  if (shaded != plain && few && shape.material.opacity >= 1.0 && parts.area() < kSmallPart * all.area()) {
    drawIn(all, plain);
    for (const PixelBox& part : parts.parts()) {
      const auto holds = [&part](const PixelBox& other) { return part.within(other).area() == part.area(); };
      if (std::none_of(drawn_again_.begin(), drawn_again_.end(), holds)) drawIn(part, shaded);
    }
  } else {
    drawIn(all, shaded);
  }
  gl_.Disable(GL_SCISSOR_TEST);
  if (reaches_far) gl_.Disable(GL_CLIP_DISTANCE0);
}

void SolidPainter::draw(const Item& item, const PinholeView& view, const GlMesh& mesh, const std::string& letters,
                        const PixelBox& where, bool split) {
  for (const MeshPart& part : mesh.parts) {
    for (const TapRows& rows : tapRowsOf(part, item.X_CS, view, where, split)) {
      const PixelBox& box = rows.where;
      gl_.Scissor(box.u0, box.v0, box.u1 - box.u0, box.v1 - box.v0);
      draw(item, view, mesh, part, letters, rows.taps);
    }
  }
}

void SolidPainter::draw(const Item& item, const PinholeView& view, const GlMesh& mesh, const MeshPart& part,
                        const std::string& letters, int taps) {
  const Shape& shape = *item.shape;
  const Material& material = shape.material;
  const Eigen::RowVector3d axis = view.R_FC.row(2);
  const Eigen::Matrix4f projection = view.projection(camera_->nearM()), placed = item.X_CS.cast<float>();
  const Eigen::Vector3f color = unit(shape.color);
  const Program& program = programOf(item, mesh, part.picture, taps, letters);
  gl_.UniformMatrix4fv(program.projection, 1, GL_FALSE, projection.data());
  gl_.UniformMatrix4fv(program.placed, 1, GL_FALSE, placed.data());
  gl_.Uniform4f(program.shape_color, color.x(), color.y(), color.z(), 1.0f);
  gl_.Uniform4f(program.far_plane, float(-axis.x()), float(-axis.y()), float(-axis.z()), float(camera_->farM()));
  // A colour of its own that ambient light meets adds to the light it gives.
  const bool own = material.ambient && !part.picture && !material.unlit;
  Eigen::Vector3f ambient = float(own ? 0.0 : material.ambient_share) * lights_->ambient.cast<float>();
  if (material.unlit) ambient.setOnes();
  Eigen::Vector3f glow = material.emissive.cast<float>();
  if (material.unlit) glow.setZero();
  if (own) glow += material.ambient->cwiseProduct(lights_->ambient).cast<float>();
  const Eigen::Vector3f highlight = material.specular.cast<float>();
  gl_.Uniform3f(program.ambient, ambient.x(), ambient.y(), ambient.z());
  gl_.Uniform3f(program.emissive, glow.x(), glow.y(), glow.z());
  gl_.Uniform1f(program.opacity, material.opacity < 1.0 ? static_cast<float>(material.opacity) : kUnmarked);
  gl_.Uniform3f(program.highlight, highlight.x(), highlight.y(), highlight.z());
  gl_.Uniform1f(program.shininess, static_cast<float>(material.shininess));
  constexpr double kSlack = 2.0;  // errors of the mesh, so that it does not lie in the shadow of what it stands for
  gl_.Uniform1f(program.slack, static_cast<float>(kSlack * mesh.error_m));
  if (part.picture) {
    const MeshPicture& picture = *part.picture;
    store_.bindPicture(picture.texture, picture.wrap_s, picture.wrap_t, false);
    if (picture.normals) store_.bindPicture(picture.normals, picture.wrap_s, picture.wrap_t, false, kBumpsUnit);
  }
  for (const auto& [first, count] : seenRuns(part.blocks, item.X_CS, view, camera_->nearM())) {
    gl_.DrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(std::size_t(first) * sizeof(std::uint32_t)));
  }
}

SolidPainter::Program& SolidPainter::programOf(const Item& item, const GlMesh& mesh, const MeshPicture* picture,
                                               int taps, const std::string& letters) {
  const Shape& shape = *item.shape;
  ShaderTraits traits;
  traits.lights = letters;
  traits.clamps_light = lights_->clamps_light;
  traits.textured = picture != nullptr;
  if (picture) traits.taps = taps;
  traits.bumpy = picture && picture->normals;
  traits.specular = most_highlight_.cwiseProduct(shape.material.specular).maxCoeff() >= least_highlight_;
  traits.sharp = traits.specular && shape.material.shininess != 1.0;
  traits.by_root = traits.specular && shape.material.shininess == 1.5;
  traits.fog = scene_->lighting.fog.has_value();
  traits.two_sided = shape.material.two_sided;
  traits.faceted = mesh.faceted && !traits.two_sided && !traits.bumpy;
  traits.painted = !shape.mesh->colors.empty();
  Program& program = programs_[traits.name()];
  if (!program.shader) {
    program.shader = std::make_unique<ShaderProgram>(gl_, traits.name(), solidShader(traits));
    findUniforms(program);
  }
  program.shader->use();
  if (program.frame != frame_) setLights(program);
  return program;
}

void SolidPainter::findUniforms(Program& program) const {
  const ShaderProgram& at = *program.shader;
  program.projection = at["projection"];
  program.placed = at["placed"];
  program.shape_color = at["shape_color"];
  program.ambient = at["ambient"];
  program.emissive = at["emissive"];
  program.opacity = at["opacity"];
  program.highlight = at["highlight"];
  program.shininess = at["shininess"];
  program.slack = at["slack"];
  program.far_plane = at["far_plane"];
  program.picture = at["picture"];
  program.bumps = at["bumps"];
  program.fog = at["fog"];
  for (std::size_t k = 0; k < letters_.size(); ++k) {
    const std::string number = std::to_string(k);
    const auto place = [&](const char* array) { return at[(array + ("[" + number + "]")).c_str()]; };
    program.lights.push_back({place("place"), place("axis"), place("cone"), place("fade"), place("diffuse"),
                              place("bright"), place("shadow_of"), place("lift"), place("reach"), place("texel_of_map"),
                              at[("map" + number).c_str()]});
  }
}

void SolidPainter::setLights(Program& program) {
  program.frame = frame_;
  gl_.Uniform1i(program.picture, 0);
  gl_.Uniform1i(program.bumps, kBumpsUnit);
  if (const auto& fog = scene_->lighting.fog) {
    const Eigen::Vector3f color = unit(fog->color);
    gl_.Uniform4f(program.fog, color.x(), color.y(), color.z(), static_cast<float>(fog->density_per_m));
  }
  const Pose X_CW = X_WC_.inverse();
  const Eigen::Matrix4d X_WC = X_WC_.matrix();
  int unit_of_map = kFirstMapUnit;
  // A program of unlit surfaces may have been made when there were fewer lights.
  for (std::size_t k = 0; k < std::min(lights_->lights.size(), program.lights.size()); ++k) {
    const Light& light = lights_->lights[k];
    const Program::OfLight& at = program.lights[k];
    const auto set3 = [&](GLint place, const Eigen::Vector3d& value) {
      gl_.Uniform3f(place, float(value.x()), float(value.y()), float(value.z()));
    };
    const Eigen::Vector3d toward = -(X_CW.q * light.direction_W.normalized());
    set3(at.place, light.type == Light::Type::kDirectional ? toward : X_CW * light.position_W);
    set3(at.axis, toward);
    const double inner = std::cos(0.5 * light.inner_angle_rad), outer = std::cos(0.5 * light.outer_angle_rad);
    set3(at.cone, {outer, 1.0 / std::max(1e-6, inner - outer), std::max(light.falloff, 1e-3)});  // no power 0 of 0
    gl_.Uniform4f(at.fade, float(std::min(light.range_m, 1e30)), float(light.constant), float(light.linear_per_m),
                  float(light.quadratic_per_m2));
    set3(at.diffuse, light.diffuse);
    set3(at.bright, light.specular);
    if (!std::isupper(letters_[k])) continue;
    const ShadowMaps::Map& map = shadows_.map(k);
    const Eigen::Matrix4f shadow_of = (map.of_world * X_WC).cast<float>();
    gl_.UniformMatrix4fv(at.shadow_of, 1, GL_FALSE, shadow_of.data());
    gl_.Uniform1f(at.lift, static_cast<float>(ShadowView::kLift * map.texel));
    gl_.Uniform2f(at.reach, float(map.near), float(map.far));
    gl_.Uniform2f(at.texel_of_map, float(1.0 / map.width), float(1.0 / map.height));
    gl_.Uniform1i(at.map, unit_of_map);
    gl_.ActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit_of_map));
    gl_.BindTexture(map.target(), map.texture);
    ++unit_of_map;
  }
}

void SolidPainter::drawSky(const PinholeView& view) {
  if (!scene_->lighting.zenith) return;
  if (!sky_) {
    sky_ = std::make_unique<ShaderProgram>(gl_, "sky", skyShader());
    const float corners[] = {-1.0f, -1.0f, 0.0f, 3.0f, -1.0f, 0.0f, -1.0f, 3.0f, 0.0f};
    gl_.GenVertexArrays(1, &sky_array_);
    gl_.GenBuffers(1, &sky_vertices_);
    gl_.BindVertexArray(sky_array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, sky_vertices_);
    gl_.BufferData(GL_ARRAY_BUFFER, sizeof(corners), corners, GL_STATIC_DRAW);
    gl_.EnableVertexAttribArray(0);
    gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  Eigen::Matrix3d ray_of;  // of (x, y, 1), x and y from -1 to 1 over the picture
  ray_of << 0.5 * view.width / view.fx, 0.0, (0.5 * view.width - 0.5 - view.cx) / view.fx, 0.0,
      0.5 * view.height / view.fy, (0.5 * view.height - 0.5 - view.cy) / view.fy, 0.0, 0.0, 1.0;
  Eigen::Matrix4f M = Eigen::Matrix4f::Zero();
  M.topLeftCorner<3, 3>() = (X_WC_.q.toRotationMatrix() * view.R_FC.transpose() * ray_of).cast<float>();
  const Eigen::Vector3f horizon = unit(scene_->background), zenith = unit(*scene_->lighting.zenith);
  sky_->use();
  gl_.UniformMatrix4fv((*sky_)["ray_of"], 1, GL_FALSE, M.data());
  gl_.Uniform3f((*sky_)["horizon"], horizon.x(), horizon.y(), horizon.z());
  gl_.Uniform3f((*sky_)["zenith"], zenith.x(), zenith.y(), zenith.z());
  gl_.BindVertexArray(sky_array_);
  gl_.Disable(GL_CULL_FACE);
  gl_.DepthFunc(GL_GEQUAL);
  gl_.DepthMask(GL_FALSE);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(limit_.u0, limit_.v0, limit_.u1 - limit_.u0, limit_.v1 - limit_.v0);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Disable(GL_SCISSOR_TEST);
  gl_.DepthMask(GL_TRUE);
}

}  // namespace aras_visual_servo_sim
