#include "shadow_maps.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "solid_shader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kFaces = 6;
constexpr double kCoarsest = 1.5;  // [texels] how far a shadow may be from where it belongs; its edge is as soft as 3

/** Rows x, y, z of a frame whose z is the direction. */
Eigen::Matrix3d frameAlong(const Eigen::Vector3d& direction) {
  return Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/** Rows s, t and the axis of face k of a cube map, as OpenGL has them. */
Eigen::Matrix3d faceOfCube(int k) {
  static const double kRows[kFaces][3][3] = {{{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
                                             {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},   {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                             {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  Eigen::Matrix3d R;
  for (int row = 0; row < 3; ++row) R.row(row) = Eigen::Map<const Eigen::RowVector3d>(kRows[k][row]);
  return R;
}

/** To coordinates and depth, each 0 .. 1, of a pyramid along z. @param wide  tangent of half its angle */
Eigen::Matrix4d perspective(double wide, double near, double far) {
  Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
  S(0, 0) = S(1, 1) = 0.5 / wide;
  S(0, 2) = S(1, 2) = 0.5;
  S(2, 2) = far / (far - near);
  S(2, 3) = -near * far / (far - near);
  S(3, 2) = 1.0;
  return S;
}

/** From the world to a frame at p_W. @param R  its axes, as rows */
Eigen::Matrix4d toFrame(const Eigen::Matrix3d& R, const Eigen::Vector3d& p_W) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Identity();
  X.topLeftCorner<3, 3>() = R;
  X.topRightCorner<3, 1>() = -R * p_W;
  return X;
}

/** Tangent of half the angle of a spot's map, a little wider than its light. */
double widthOf(const Light& spot) { return std::tan(std::min(0.5 * spot.outer_angle_rad + 0.02, 1.5)); }

}  // namespace

ShadowMaps::~ShadowMaps() { free(); }

void ShadowMaps::free() {
  for (Entry& entry : maps_) free(entry);
  maps_.clear();
}

void ShadowMaps::free(Entry& entry) {
  if (entry.frame) gl_.DeleteFramebuffers(1, &entry.frame);
  if (entry.map.texture) gl_.DeleteTextures(1, &entry.map.texture);
  entry = Entry();
}

void ShadowMaps::update(const Scene& scene, const LightSet& lights, int side, GlStore& store) {
  if (side != side_ || lights.lights.size() != maps_.size()) {
    free();
    side_ = side;
    maps_.resize(lights.lights.size());
  }
  casters_.clear();
  for (const Body& body : scene.bodies) {
    if (!body.visible || !body.casts_shadows) continue;
    for (const Shape& shape : body.shapes) {
      if (shape.material.opacity < 1.0) continue;
      const Pose X_WS = body.X_WB * shape.X_BS;
      const Eigen::Vector3f middle = 0.5f * (shape.mesh->box_min + shape.mesh->box_max);
      casters_.push_back({&shape, X_WS.matrix(), X_WS * middle.cast<double>(),
                          0.5 * (shape.mesh->box_max - shape.mesh->box_min).cast<double>().norm()});
    }
  }
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    if (!lights.shades(k)) continue;
    const Light& light = lights.lights[k];
    Entry& entry = maps_[k];
    choose(light);
    Map map;
    map.target = light.type == Light::Type::kPoint ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D;
    place(light, map);
    if (map.target != entry.map.target || map.width != entry.map.width || map.height != entry.map.height) free(entry);
    map.texture = entry.map.texture;
    entry.map = map;
    if (!entry.frame) allocate(entry);
    std::vector<double> key(entry.map.of_world.data(), entry.map.of_world.data() + 16);
    key.insert(key.end(), {entry.map.near, entry.map.far});
    for (const Caster* caster : chosen_) {
      key.push_back(static_cast<double>(store.mesh(caster->shape->mesh).serial));
      key.insert(key.end(), caster->X_WS.data(), caster->X_WS.data() + 16);
    }
    if (key == entry.key) continue;
    draw(entry, store);
    entry.key = std::move(key);
  }
}

/** Of the things that cast shadows, those that the light reaches. */
void ShadowMaps::choose(const Light& light) {
  chosen_.clear();
  const Eigen::Vector3d axis = light.direction_W.normalized();
  for (const Caster& caster : casters_) {
    const Eigen::Vector3d ray = caster.center_W - light.position_W;
    bool reached = true;
    if (light.type != Light::Type::kDirectional) reached = ray.norm() < light.range_m + caster.radius_m;
    if (light.type == Light::Type::kSpot && reached) {  // the ball and the cone about the map's pyramid
      const double wide = std::sqrt(2.0) * widthOf(light), along = axis.dot(ray);
      const double across = (ray - along * axis).norm();
      reached =
          along + caster.radius_m > 0.0 && across - wide * along <= caster.radius_m * std::sqrt(1.0 + wide * wide);
    }
    if (reached) chosen_.push_back(&caster);
  }
}

/** The part of the world that the map shows: all that casts a shadow, or all around a point light. */
void ShadowMaps::place(const Light& light, Map& map) const {
  const bool point = light.type == Light::Type::kPoint;
  map.width = map.height = point ? std::max(1, side_ / 2) : side_;
  map.directional = light.type == Light::Type::kDirectional;
  map.light_W = light.position_W;
  Eigen::Matrix3d R_LW = Eigen::Matrix3d::Identity();
  if (!point) R_LW = frameAlong(light.direction_W.normalized());
  if (!map.directional) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
    for (const Caster* caster : chosen_) {
      const Eigen::Vector3d ray = caster->center_W - light.position_W;
      const double distance = point ? ray.norm() : R_LW.row(2).dot(ray);
      nearest = std::min(nearest, distance - caster->radius_m);
      farthest = std::max(farthest, distance + caster->radius_m);
    }
    map.far = std::max(1.01 * std::min(farthest, light.range_m), 1e-3);
    // Half: a thing in the corner of a cube's face is 1 / sqrt(3) of its distance before that face.
    map.near = std::clamp(0.5 * nearest, 1e-3 * map.far, 0.5 * map.far);
    const double wide = point ? 1.0 : widthOf(light);
    const Eigen::Matrix4d X_LW = toFrame(R_LW, light.position_W);
    map.of_world = point ? X_LW : Eigen::Matrix4d(perspective(wide, map.near, map.far) * X_LW);
    map.texel = 2.0 * wide / map.width;
    return;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(infinity), high = -low;
  for (const Caster* caster : chosen_) {
    const TriangleMesh& mesh = *caster->shape->mesh;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector4d corner(k & 1 ? mesh.box_max.x() : mesh.box_min.x(),
                                   k & 2 ? mesh.box_max.y() : mesh.box_min.y(),
                                   k & 4 ? mesh.box_max.z() : mesh.box_min.z(), 1.0);
      const Eigen::Vector3d p_L = R_LW * (caster->X_WS * corner).head<3>();
      low = low.cwiseMin(p_L);
      high = high.cwiseMax(p_L);
    }
  }
  if (chosen_.empty()) low = high = Eigen::Vector3d::Zero();
  constexpr double kRim = 4.0;  // [px] beyond the things, for soft edges
  Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
  const double widest = std::max({high.x() - low.x(), high.y() - low.y(), 1e-6});
  constexpr double kThinnest_m = 2e-3;  // so that what is drawn behind its place for rounding is still within the map
  const double depth = std::max(high.z() - low.z(), kThinnest_m);
  map.texel = widest / (side_ - 2.0 * kRim);
  const auto texelsOf = [&](double length) {
    constexpr int kStep = 128;  // [px] so that things which turn seldom ask for another size
    const double texels = length / map.texel + 2.0 * kRim;
    return std::min(side_, kStep * static_cast<int>(std::ceil(texels / kStep)));
  };
  map.width = texelsOf(high.x() - low.x());
  map.height = texelsOf(high.y() - low.y());
  const double size_x = map.texel * map.width, size_y = map.texel * map.height;
  const Eigen::Vector3d middle = 0.5 * (low + high);
  S.block<1, 3>(0, 0) = R_LW.row(0) / size_x;
  S.block<1, 3>(1, 0) = R_LW.row(1) / size_y;
  S.block<1, 3>(2, 0) = R_LW.row(2) / (1.02 * depth);
  S.col(3) << 0.5 - middle.x() / size_x, 0.5 - middle.y() / size_y, 0.5 - middle.z() / (1.02 * depth), 1.0;
  map.of_world = S;
}

void ShadowMaps::allocate(Entry& entry) {
  Map& map = entry.map;
  const bool cube = map.target == GL_TEXTURE_CUBE_MAP;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.GenTextures(1, &map.texture);
  gl_.BindTexture(map.target, map.texture);
  for (int k = 0; k < (cube ? kFaces : 1); ++k) {
    gl_.TexImage2D(cube ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + k : GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, map.width,
                   map.height, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  }
  gl_.TexParameteri(map.target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl_.TexParameteri(map.target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // Beyond a map of parallel light there is nothing, as at its rim; beyond that of a spot there is no light.
  gl_.TexParameteri(map.target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl_.TexParameteri(map.target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl_.TexParameteri(map.target, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl_.TexParameteri(map.target, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl_.GenFramebuffers(1, &entry.frame);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, cube ? GL_TEXTURE_CUBE_MAP_POSITIVE_X : GL_TEXTURE_2D,
                           map.texture, 0);
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("renderer 'opengl': no shadow map of " + std::to_string(map.width) + " x " +
                      std::to_string(map.height) + " px");
  }
}

void ShadowMaps::draw(const Entry& entry, GlStore& store) {
  ++drawn_;
  if (!program_) program_ = std::make_unique<ShaderProgram>(gl_, "depth", depthVertexShader(), depthFragmentShader());
  const Map& map = entry.map;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.Viewport(0, 0, map.width, map.height);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_LESS);
  gl_.ClearDepth(1.0);
  program_->use();
  if (map.target == GL_TEXTURE_2D) return drawSquare(map, map.of_world, store);
  const std::vector<const Caster*> all = chosen_;
  for (int face = 0; face < kFaces; ++face) {
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, map.texture,
                             0);
    const Eigen::Matrix3d R = faceOfCube(face);
    chosen_.clear();
    for (const Caster* caster : all) {  // the ball and the four sides of the pyramid
      const Eigen::Vector3d p = R * (map.of_world * caster->center_W.homogeneous()).head<3>();
      if (std::max(std::abs(p.x()), std::abs(p.y())) - p.z() < std::sqrt(2.0) * caster->radius_m) {
        chosen_.push_back(caster);
      }
    }
    drawSquare(map, perspective(1.0, map.near, map.far) * toFrame(R, Eigen::Vector3d::Zero()) * map.of_world, store);
  }
  chosen_ = all;
}

void ShadowMaps::drawSquare(const Map& map, const Eigen::Matrix4d& of_world, GlStore& store) {
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  const GLint projection = (*program_)["projection"];
  Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
  to_clip(0, 0) = to_clip(1, 1) = 2.0;
  to_clip(0, 3) = to_clip(1, 3) = -1.0;
  // Behind where things are by more than single precision errs by, so that what light meets straight on is lit.
  constexpr double kRounding = 1e-6, kRounding_m = 1e-5;
  to_clip(2, 3) = kRounding + (map.directional ? kRounding_m * map.of_world.row(2).head<3>().norm() : 0.0);
  for (const Caster* caster : chosen_) {
    const Eigen::Matrix4f P = (to_clip * of_world * caster->X_WS).cast<float>();
    gl_.UniformMatrix4fv(projection, 1, GL_FALSE, P.data());
    double texel_m = map.texel;
    if (!map.directional) texel_m *= std::max(map.near, (caster->center_W - map.light_W).norm() - caster->radius_m);
    const GlOutline outline = store.outline(caster->shape->mesh, kCoarsest * texel_m);
    // Of what is closed the near side hides the far one. The faces of a cube are mirrored: there both are drawn.
    if (outline.closed && map.target == GL_TEXTURE_2D) {
      gl_.Enable(GL_CULL_FACE);
    } else {
      gl_.Disable(GL_CULL_FACE);
    }
    gl_.BindVertexArray(outline.array);
    gl_.DrawElements(GL_TRIANGLES, outline.index_count, GL_UNSIGNED_INT, nullptr);
  }
}

}  // namespace aras_visual_servo_sim
