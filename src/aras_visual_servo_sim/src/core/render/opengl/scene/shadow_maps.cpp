#include "shadow_maps.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "solid_shader.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Rows x, y, z of a frame whose z is the direction. */
Eigen::Matrix3d frameAlong(const Eigen::Vector3d& direction) {
  return Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

ShadowMaps::~ShadowMaps() { free(); }

void ShadowMaps::free() {
  for (const Entry& entry : maps_) {
    if (entry.frame) gl_.DeleteFramebuffers(1, &entry.frame);
    if (entry.map.texture) gl_.DeleteTextures(1, &entry.map.texture);
  }
  maps_.clear();
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
      casters_.push_back({&shape, (body.X_WB * shape.X_BS).matrix()});
    }
  }
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    if (!lights.shades(k)) continue;
    Entry& entry = maps_[k];
    if (!entry.frame) allocate(entry);
    const bool any = place(lights.lights[k], entry.map);
    std::vector<double> key{any ? 1.0 : 0.0};
    key.insert(key.end(), entry.map.of_world.data(), entry.map.of_world.data() + 16);
    for (const Caster& caster : casters_) {
      key.push_back(static_cast<double>(store.mesh(caster.shape->mesh).serial));
      key.insert(key.end(), caster.X_WS.data(), caster.X_WS.data() + 16);
    }
    if (key == entry.key) continue;
    draw(entry, store);
    entry.key = std::move(key);
  }
}

/** The part of the world that the map shows: all that casts a shadow. @return false if nothing does */
bool ShadowMaps::place(const Light& light, Map& map) const {
  const Eigen::Matrix3d R_LW = frameAlong(light.direction_W.normalized());
  const bool spot = light.type == Light::Type::kSpot;
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(infinity), high = -low;
  for (const Caster& caster : casters_) {
    const TriangleMesh& mesh = *caster.shape->mesh;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector4d corner(k & 1 ? mesh.box_max.x() : mesh.box_min.x(),
                                   k & 2 ? mesh.box_max.y() : mesh.box_min.y(),
                                   k & 4 ? mesh.box_max.z() : mesh.box_min.z(), 1.0);
      const Eigen::Vector3d p_W = (caster.X_WS * corner).head<3>();
      const Eigen::Vector3d p_L = R_LW * (spot ? Eigen::Vector3d(p_W - light.position_W) : p_W);
      low = low.cwiseMin(p_L);
      high = high.cwiseMax(p_L);
    }
  }
  if (!(low.x() <= high.x())) return false;
  constexpr double kRim = 4.0;  // [px] beyond the things, for soft edges
  Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
  if (!spot) {
    const double widest = std::max({high.x() - low.x(), high.y() - low.y(), 1e-6});
    const double depth = std::max(high.z() - low.z(), 1e-6);
    const double size = widest * side_ / (side_ - 2.0 * kRim);
    const Eigen::Vector3d middle = 0.5 * (low + high);
    S.block<1, 3>(0, 0) = R_LW.row(0) / size;
    S.block<1, 3>(1, 0) = R_LW.row(1) / size;
    S.block<1, 3>(2, 0) = R_LW.row(2) / (1.02 * depth);
    S.col(3) << 0.5 - middle.x() / size, 0.5 - middle.y() / size, 0.5 - middle.z() / (1.02 * depth), 1.0;
    map.texel_m = size / side_;
  } else {
    const double far = std::max(high.z() * 1.01, 1e-3), near = std::max(low.z() * 0.99, 1e-3 * far);
    const double wide = std::tan(std::min(0.5 * light.outer_angle_rad + 0.02, 1.5));
    S(0, 0) = S(1, 1) = 0.5 / wide;
    S(0, 2) = S(1, 2) = 0.5;
    S(2, 2) = far / (far - near);
    S(2, 3) = -near * far / (far - near);
    S(3, 2) = 1.0;
    Eigen::Matrix4d X_LW = Eigen::Matrix4d::Identity();
    X_LW.topLeftCorner<3, 3>() = R_LW;
    X_LW.topRightCorner<3, 1>() = -R_LW * light.position_W;
    S = (S * X_LW).eval();
    map.texel_m = 2.0 * wide * far / side_;
  }
  map.of_world = S;
  return true;
}

void ShadowMaps::allocate(Entry& entry) {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.GenTextures(1, &entry.map.texture);
  gl_.BindTexture(GL_TEXTURE_2D, entry.map.texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, side_, side_, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const float beyond[] = {1.0f, 1.0f, 1.0f, 1.0f};
  gl_.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, beyond);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl_.GenFramebuffers(1, &entry.frame);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, entry.map.texture, 0);
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("renderer 'opengl': no shadow map of " + std::to_string(side_) + " px a side");
  }
}

void ShadowMaps::draw(Entry& entry, GlStore& store) {
  ++drawn_;
  if (!program_) program_ = std::make_unique<ShaderProgram>(gl_, "depth", depthVertexShader(), depthFragmentShader());
  gl_.BindFramebuffer(GL_FRAMEBUFFER, entry.frame);
  gl_.Viewport(0, 0, side_, side_);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_LESS);
  gl_.ClearDepth(1.0);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Disable(GL_CULL_FACE);
  program_->use();
  const GLint projection = (*program_)["projection"];
  Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
  to_clip(0, 0) = to_clip(1, 1) = 2.0;
  to_clip(0, 3) = to_clip(1, 3) = -1.0;
  for (const Caster& caster : casters_) {
    const Eigen::Matrix4f P = (to_clip * entry.map.of_world * caster.X_WS).cast<float>();
    gl_.UniformMatrix4fv(projection, 1, GL_FALSE, P.data());
    const GlMesh& mesh = store.mesh(caster.shape->mesh);
    gl_.BindVertexArray(mesh.array);
    gl_.DrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
  }
}

}  // namespace aras_visual_servo_sim
