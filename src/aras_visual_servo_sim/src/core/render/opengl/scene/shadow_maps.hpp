#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gl_lights.hpp"
#include "gl_store.hpp"
#include "render/opengl/gl/shader_program.hpp"

namespace aras_visual_servo_sim {

/** What each light that casts shadows sees: the distance of the nearest thing, drawn anew only when one of the things
 *  that cast shadows, or the light, has moved. */
class ShadowMaps {
 public:
  explicit ShadowMaps(const GlFunctions& gl) : gl_(gl) {}
  ~ShadowMaps();
  ShadowMaps(const ShadowMaps&) = delete;
  ShadowMaps& operator=(const ShadowMaps&) = delete;

  /** Brings the maps up to date with the scene. Leaves another frame buffer and viewport bound.
   *  @param side  of a map [px] */
  void update(const Scene& scene, const LightSet& lights, int side, GlStore& store);

  /** The map of one light. */
  struct Map {
    Eigen::Matrix4d of_world = Eigen::Matrix4d::Identity();  ///< to the map's coordinates and depth, each 0 .. 1
    double texel_m = 0.0;                                    ///< size of a texel where the things are
    GLuint texture = 0;
  };
  /** Of light k. @pre LightSet::shades(k) at the last update */
  const Map& map(std::size_t k) const { return maps_[k].map; }
  int side() const { return side_; }
  /** How often a map was drawn so far. */
  long drawn() const { return drawn_; }

 private:
  struct Caster {
    const Shape* shape;
    Eigen::Matrix4d X_WS;
  };
  struct Entry {
    Map map;
    GLuint frame = 0;
    std::vector<double> key;  // what it shows
  };
  bool place(const Light& light, Map& map) const;
  void draw(Entry& entry, GlStore& store);
  void allocate(Entry& entry);
  void free();

  const GlFunctions& gl_;
  std::unique_ptr<ShaderProgram> program_;
  std::vector<Entry> maps_;  // of each light
  std::vector<Caster> casters_;
  int side_ = 0;
  long drawn_ = 0;
};

}  // namespace aras_visual_servo_sim
