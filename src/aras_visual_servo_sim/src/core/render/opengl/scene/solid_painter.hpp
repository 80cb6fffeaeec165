#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl_lights.hpp"
#include "gl_store.hpp"
#include "render/opengl/gl/shader_program.hpp"
#include "render/opengl/scene/shadow/shadow_maps.hpp"
#include "render/opengl/scene/shadow/shadow_reach.hpp"
#include "render/opengl/view/pinhole_view.hpp"
#include "solid_shader.hpp"

namespace aras_visual_servo_sim {

/** Draws the bodies of a scene and the sky into the canvas that is bound. */
class SolidPainter {
 public:
  SolidPainter(const GlFunctions& gl, GlStore& store) : gl_(gl), store_(store), shadows_(gl) {}
  ~SolidPainter();

  /** Takes a frame of one or more views, which must live until it is done. Draws shadow maps: bind the canvas
   *  afterwards. @param levels  of a channel: highlights that stay below half a level are left out */
  void begin(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const std::vector<PinholeView>& views,
             int levels);
  /** Whether some of it lets light through. */
  bool anyTransparent() const { return !transparent_.empty(); }
  /** How to draw a view so that several samples are taken only where they can differ. */
  struct Plan {
    struct Part : PixelBox {
      bool filled = false;  ///< nothing behind the backdrop is seen in it
    };
    std::vector<Part> sampled;            ///< where they can differ
    bool sky = false;                     ///< whether the sky is seen elsewhere, else the colour of the background,
    std::optional<std::size_t> backdrop;  ///< and whether one large body is before it: its place among the opaque ones
  };
  /** @param view  which one of the frame */
  Plan planOf(std::size_t view) const;
  /** From here on draws only in this part of the view, and no shadows in those that are drawn once more. */
  void drawIn(const PixelBox& part, const std::vector<Plan::Part>& drawn_again = {}) {
    limit_ = part;
    drawn_again_ = drawn_again;
  }

  void drawSky(const PinholeView& view);
  /** @param filled  by the backdrop at this place, which is drawn first, over whatever is there */
  void drawOpaque(std::size_t view, std::optional<std::size_t> filled = std::nullopt);
  /** One convex body alone, into a canvas that needs no depth. @param place  among the opaque ones */
  void drawBackdrop(std::size_t view, std::size_t place);
  /** Over all that is there, the farthest first. */
  void drawTransparent(std::size_t view);

  const ShadowMaps& shadows() const { return shadows_; }

 private:
  struct Item {
    const Shape* shape;
    Eigen::Matrix4d X_CS;
    Eigen::Vector3d center_C;
    double radius;
  };
  /** An item that a view can see. */
  struct Sight {
    const Item* item;
    PixelBox covered;     ///< the pixels that it can cover
    std::string letters;  ///< of the lights, capitals where something can throw a shadow on it
    const GlMesh* mesh;   ///< as it is drawn
  };
  /** What of the frame is seen in one view. */
  struct Seen {
    const PinholeView* view;
    std::vector<Sight> opaque, transparent;
  };
  /** A program and where its uniforms are. */
  struct Program {
    std::unique_ptr<ShaderProgram> shader;
    GLint projection, placed, shape_color, ambient, emissive, opacity, highlight, shininess, slack, far_plane, picture,
        bumps, fog;
    struct OfLight {
      GLint place, axis, cone, fade, diffuse, bright, shadow_of, lift, reach, texel_of_map, map;
    };
    std::vector<OfLight> lights;
    long frame = -1;  ///< of which the lights are set
  };
  void prepareOpaque();
  /** What a view sees of these items, and the boxes on the maps of directional lights that this takes. */
  std::vector<Sight> sightsOf(const std::vector<Item>& items, const PinholeView& view);
  /** Draws without shadows where there can be none, for they cost most of it. */
  double scaleOf(const Item& item, const PinholeView& view) const;
  void draw(const Sight& sight, const PinholeView& view);
  /** Adds where, of a view, it can lie in the shadow that light k makes. */
  void addShadowed(const Item& item, std::size_t k, const PinholeView& view, PixelParts& parts) const;
  /** Draws within these pixels. @pre the scissor is on  @param split  whether in rows */
  void draw(const Item& item, const PinholeView& view, const GlMesh& mesh, const std::string& letters,
            const PixelBox& where, bool split);
  void draw(const Item& item, const PinholeView& view, const GlMesh& mesh, const MeshPart& part,
            const std::string& letters, int taps);
  Program& programOf(const Item& item, const GlMesh& mesh, const MeshPicture* picture, int taps,
                     const std::string& letters);
  void findUniforms(Program& program) const;
  void setLights(Program& program);
  bool isSeen(const Item& item, const PinholeView& view) const;
  bool isAroundEye(const Item& item) const;
  /** Of the opaque ones the place of the one that can be a backdrop, if it covers much of the view. */
  std::optional<std::size_t> backdropOf(const Seen& seen) const;
  bool isFilled(const Seen& seen, std::size_t backdrop, const PixelBox& part) const;

  const GlFunctions& gl_;
  GlStore& store_;
  ShadowMaps shadows_;
  std::map<std::string, Program> programs_;
  std::unique_ptr<ShaderProgram> sky_;
  GLuint sky_array_ = 0, sky_vertices_ = 0;

  const CameraModel* camera_ = nullptr;
  const Scene* scene_ = nullptr;
  Pose X_WC_;
  std::unique_ptr<LightSet> lights_;
  std::string letters_;
  Eigen::Vector3d most_highlight_;  // of a material of specular 1 that all lights meet
  double least_highlight_ = 0.0;    // that is drawn
  std::vector<Item> opaque_, transparent_;
  std::vector<Seen> seen_;                   // by the views of the frame
  std::vector<std::vector<MapBox>> shaded_;  // by light, what can be seen of the items
  PixelBox limit_;
  std::vector<Plan::Part> drawn_again_;
  long frame_ = 0;
};

}  // namespace aras_visual_servo_sim
