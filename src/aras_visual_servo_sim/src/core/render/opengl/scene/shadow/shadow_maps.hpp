#pragma once

#include <Eigen/Core>
#include <list>
#include <memory>
#include <vector>

#include "render/opengl/gl/shader_program.hpp"
#include "render/opengl/scene/gl_lights.hpp"
#include "render/opengl/scene/gl_store.hpp"
#include "shadow_view.hpp"

namespace aras_visual_servo_sim {

/** What each light that casts shadows sees: the distance of the nearest thing.
 *
 *  A map is begun anew only when one of the things that the light reaches and that cast shadows, or the light, has
 *  moved. All cameras that see the same things share it, also those of other scenes; into it come, when a first camera
 *  needs them, those things alone that can shade what it sees. */
class ShadowMaps {
 public:
  explicit ShadowMaps(const GlFunctions& gl) : gl_(gl) {}
  ~ShadowMaps();
  ShadowMaps(const ShadowMaps&) = delete;
  ShadowMaps& operator=(const ShadowMaps&) = delete;

  /** Finds the maps of a scene's lights. @param side  of a map, the longer one of a rectangle [px] */
  void update(const Scene& scene, const LightSet& lights, int side, GlStore& store);
  /** Whether anything that light k reaches can shade what is in a box on its map. @pre the light is directional */
  bool canShade(std::size_t k, const MapBox& box) const;
  /** Of all that light k reaches and that casts shadows, the boxes on its map. @pre the light is directional */
  const std::vector<MapBox>& boxes(std::size_t k) const { return maps_[k]->boxes; }
  /** Draws what can shade these boxes and is not in the map of light k yet. Leaves another frame buffer and viewport
   *  bound. @param boxes  at the last update; of a light that is not directional any box stands for everything */
  void draw(std::size_t k, const std::vector<MapBox>& boxes, GlStore& store);

  /** The map of one light. */
  struct Map : ShadowView {
    GLuint texture = 0;
    GLenum target() const { return cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D; }
  };
  /** Of light k. @pre LightSet::shades(k) at the last update */
  const Map& map(std::size_t k) const { return maps_[k]->map; }
  /** Whether there is anything in it. */
  bool begun(std::size_t k) const { return maps_[k]->begun; }
  /** How many maps were begun so far. */
  long drawn() const { return drawn_; }
  /** How many triangles were drawn into them so far. */
  long triangles() const { return triangles_; }

 private:
  struct Entry {
    Map map;
    GLuint frame = 0;
    std::vector<double> key;             // what it shows
    const Scene* scene = nullptr;        // whose light
    std::size_t light = 0;               // it last belonged to
    std::vector<const Caster*> reached;  // at the last update
    std::vector<MapBox> boxes;           // of those, if directional
    std::vector<char> there;             // those that are in the map
    bool begun = false;
    long used = 0;
  };
  Entry& entryFor(const Scene& scene, std::size_t light, const std::vector<double>& key);
  void drawSquare(const Map& map, const Eigen::Matrix4d& of_world, const std::vector<const Caster*>& casters,
                  GlStore& store);
  void allocate(Entry& entry);
  void free(Entry& entry);

  static constexpr std::size_t kMostKept = 8;

  const GlFunctions& gl_;
  std::unique_ptr<ShaderProgram> program_;
  std::list<Entry> entries_;
  std::vector<Entry*> maps_;  // of each light; null: it has none
  std::vector<Caster> casters_;
  long updates_ = 0, drawn_ = 0, triangles_ = 0;
};

}  // namespace aras_visual_servo_sim
