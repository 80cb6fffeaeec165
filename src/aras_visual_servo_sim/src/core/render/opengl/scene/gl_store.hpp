#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"
#include "render/opengl/gl/gl_functions.hpp"
#include "render/opengl/view/seen_blocks.hpp"

namespace aras_visual_servo_sim {

/** Triangles of one mesh that have one picture, or none. */
struct MeshPart {
  const MeshPicture* picture = nullptr;
  GLsizei first = 0, count = 0;                      ///< indices
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of all its triangles; 0: they have not all the same
  double stretch = 1.0;  ///< how much finer its picture lies along one direction than across it, where it has a normal
  std::vector<TriangleBlock> blocks{};  ///< all of its triangles
};

/** Triangles to draw without their pictures. */
struct GlOutline {
  GLuint array = 0, indices = 0;
  GLsizei index_count = 0;
  bool closed = false;  ///< without its back faces it looks the same from everywhere outside
};

/** A mesh in the memory of OpenGL. */
struct GlMesh {
  MeshPtr mesh;
  MeshPtr drawn;         ///< another one that is drawn in its place; null: there is none
  double error_m = 0.0;  ///< how far that one may be from where the mesh is
  GLuint array = 0, vertices = 0, indices = 0;
  GLsizei index_count = 0;
  bool faceted = false;  ///< each of its triangles has one normal and one colour
  bool closed = false;   ///< its triangles enclose a space
  long serial = 0;       ///< no other mesh of this store ever had it
  std::vector<MeshPart> parts;
  std::map<int, GlOutline> coarse;  ///< by the logarithm of how often its cells fit into the mesh
};

/** Meshes and pictures in the memory of OpenGL: loaded at their first use, dropped when nobody else has them. */
class GlStore {
 public:
  explicit GlStore(const GlFunctions& gl) : gl_(gl) {}
  ~GlStore();
  GlStore(const GlStore&) = delete;
  GlStore& operator=(const GlStore&) = delete;

  /** Frees what no scene has any more. */
  void clean();
  const GlMesh& mesh(const MeshPtr& mesh) { return meshWith(mesh, 0); }
  /** The same as it has to be to look right: a round body with more sides, of many triangles fewer.
   *  @param px_per_m  in the image, where it is nearest */
  const GlMesh& meshSeen(const MeshPtr& mesh, double px_per_m);
  /** A mesh with fewer triangles, for its shadow. @param error_m  how far a point may be from where it is, > 0 */
  GlOutline outline(const MeshPtr& mesh, double error_m);
  /** Binds a picture to a texture unit. @param askew  seen so that a pixel covers a long strip of it
   *  @throws RenderError naming a picture too large for OpenGL */
  void bindPicture(const TexturePtr& texture, Wrap wrap_s, Wrap wrap_t, bool askew, int unit = 0);

 private:
  struct GlPicture {
    TexturePtr texture;
    GLuint name = 0;
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;  // as it is bound, which OpenGL has for itself
    bool askew = false;
  };
  /** @param detail  > 0: sides of a round body; 0: as it is; < 0: simplified by 2^detail of its size, with no array
   *      where that is not worth while */
  GlMesh& meshWith(const MeshPtr& mesh, int detail);
  void upload(GlMesh& stored);
  void makeArray(GLuint vertices, const std::vector<std::uint32_t>& indices, GLuint& array, GLuint& buffer);
  GLuint upload(const Texture& texture);
  void remove(const GlMesh& mesh);

  const GlFunctions& gl_;
  std::map<std::pair<const TriangleMesh*, int>, GlMesh> meshes_;  // by mesh and detail
  long serial_ = 0;
  std::map<const Texture*, GlPicture> pictures_;
};

}  // namespace aras_visual_servo_sim
