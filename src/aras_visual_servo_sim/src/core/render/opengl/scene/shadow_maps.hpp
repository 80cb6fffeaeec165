#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gl_lights.hpp"
#include "gl_store.hpp"
#include "render/opengl/gl/shader_program.hpp"

namespace aras_visual_servo_sim {

/** What each light that casts shadows sees: the distance of the nearest thing, drawn anew only when one of the things
 *  that it reaches and that cast shadows, or the light, has moved. */
class ShadowMaps {
 public:
  explicit ShadowMaps(const GlFunctions& gl) : gl_(gl) {}
  ~ShadowMaps();
  ShadowMaps(const ShadowMaps&) = delete;
  ShadowMaps& operator=(const ShadowMaps&) = delete;

  /** Brings the maps up to date with the scene. Leaves another frame buffer and viewport bound.
   *  @param side  of a map, the longer one of a rectangle [px] */
  void update(const Scene& scene, const LightSet& lights, int side, GlStore& store);

  /** The map of one light. */
  struct Map {
    /** To the map's coordinates and depth, each 0 .. 1; of a cube to its frame: the world's axes, the light at 0. */
    Eigen::Matrix4d of_world = Eigen::Matrix4d::Identity();
    double texel = 0.0;            ///< width of a texel: of a directional light [m], else over the distance
    double near = 0.0, far = 1.0;  ///< of a cube's faces [m]
    bool directional = true;
    Eigen::Vector3d light_W = Eigen::Vector3d::Zero();  ///< where the light is, unless directional
    GLenum target = 0;                                  ///< GL_TEXTURE_2D or, of a point light, GL_TEXTURE_CUBE_MAP
    GLuint texture = 0;
    int width = 0, height = 0;  ///< of the map, or of a face [px]
  };
  /** Of light k. @pre LightSet::shades(k) at the last update */
  const Map& map(std::size_t k) const { return maps_[k].map; }
  /** How often a map was drawn so far. */
  long drawn() const { return drawn_; }

 private:
  struct Caster {
    const Shape* shape;
    Eigen::Matrix4d X_WS;
    Eigen::Vector3d center_W;  // of the ball that holds it
    double radius_m;
  };
  struct Entry {
    Map map;
    GLuint frame = 0;
    std::vector<double> key;  // what it shows
  };
  void choose(const Light& light);
  void place(const Light& light, Map& map) const;
  void draw(const Entry& entry, GlStore& store);
  void drawSquare(const Map& map, const Eigen::Matrix4d& of_world, GlStore& store);
  void allocate(Entry& entry);
  void free();
  void free(Entry& entry);

  const GlFunctions& gl_;
  std::unique_ptr<ShaderProgram> program_;
  std::vector<Entry> maps_;  // of each light
  std::vector<Caster> casters_;
  std::vector<const Caster*> chosen_;  // for the map at hand
  int side_ = 0;
  long drawn_ = 0;
};

}  // namespace aras_visual_servo_sim
