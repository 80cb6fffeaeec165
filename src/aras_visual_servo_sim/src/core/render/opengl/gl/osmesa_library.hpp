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

/** One that no other thread uses as long as this one holds it. llvmpipe draws for one context at a time, so that
 * threads which draw at once need a library each: the first has that of the file, the others have copies of it in
 * memory. Where there can be no copy, or none more, threads share one and wait for each other. @throws RenderError as
 * SharedLibrary */
std::shared_ptr<const OsmesaLibrary> osmesaOfThread();

}  // namespace aras_visual_servo_sim
