#pragma once

// clang-format off: the types of OpenGL's functions first, as osmesa.h brings gl.h without them
#include "gl_functions.hpp"
// clang-format on

#include <GL/osmesa.h>

#include <memory>

namespace aras_visual_servo_sim {

/** An OSMesa in memory. */
struct OsmesaLibrary {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) address;
};

/** An OSMesa that no other thread uses as long as this one holds it. */
struct OsmesaOfThread {
  OsmesaLibrary library;
  int threads = 0;  ///< beside the calling one, that draw an image

  /** A context with these attributes; null: there is none. */
  OSMesaContext create(const int* wanted) const;
};

/** llvmpipe draws for one context at a time, so that threads which draw at once need a library each: the first has that
 *  of the file, the others have copies of it in memory. It also decides once in how many threads it draws: 0 for small
 *  images, which are drawn fastest in the calling thread, or as many as there are processors. LP_NUM_THREADS, where the
 *  user has set it, decides for all. Where there can be no copy, or none more, threads share one and wait for each
 * other.
 *  @param wide  for large images
 *  @throws RenderError as SharedLibrary */
std::shared_ptr<OsmesaOfThread> osmesaOfThread(bool wide);

}  // namespace aras_visual_servo_sim
