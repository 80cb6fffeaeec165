#pragma once

#include <GL/osmesa.h>

namespace aras_visual_servo_sim {

/** The functions of OSMesa and of its OpenGL that we use.
 *
 *  OSMesa is opened at run time and OpenGL taken from OSMesaGetProcAddress: OpenCV and ViSP bring libGL into the same
 *  process, and linked gl* symbols would resolve there, where there is no context. */
struct OsmesaLibrary {
  decltype(&OSMesaCreateContextExt) createContext;
  decltype(&OSMesaDestroyContext) destroyContext;
  decltype(&OSMesaMakeCurrent) makeCurrent;

  decltype(&glClear) clear;
  decltype(&glClearColor) clearColor;
  decltype(&glClearDepth) clearDepth;
  decltype(&glColorPointer) colorPointer;
  decltype(&glDepthFunc) depthFunc;
  decltype(&glDisable) disable;
  decltype(&glDrawArrays) drawArrays;
  decltype(&glEnable) enable;
  decltype(&glEnableClientState) enableClientState;
  decltype(&glFinish) finish;
  decltype(&glGetError) getError;
  decltype(&glLoadIdentity) loadIdentity;
  decltype(&glMatrixMode) matrixMode;
  decltype(&glOrtho) ortho;
  decltype(&glVertexPointer) vertexPointer;
  decltype(&glViewport) viewport;

  /** Opens the library on first use and sets LP_NUM_THREADS=0 unless the user set it: frames are so small that llvmpipe
   *  is fastest in the calling thread. @throws RenderError if libOSMesa or a function of it is missing */
  static const OsmesaLibrary& instance();
};

}  // namespace aras_visual_servo_sim
