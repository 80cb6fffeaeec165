#pragma once

#include <memory>
#include <string>

#include "gl_functions.hpp"

namespace aras_visual_servo_sim {

/** An OpenGL context without a window. Whatever it draws goes to framebuffer objects. */
class GlContext {
 public:
  virtual ~GlContext() = default;

  /** Binds it to the calling thread while it lives. The context must not be bound to another thread then. */
  class Binding {
   public:
    /** @throws RenderError if the context was lost */
    explicit Binding(GlContext& context) : context_(context) { context_.bind(); }
    ~Binding() { context_.release(); }
    Binding(const Binding&) = delete;
    Binding& operator=(const Binding&) = delete;

   private:
    GlContext& context_;
  };

  const GlFunctions& gl() const { return gl_; }
  /** What draws and which version it is of, for example "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa
   *  22.3.6". @pre bound */
  std::string description() const;

 protected:
  GlFunctions gl_;

 private:
  virtual void bind() = 0;
  virtual void release() = 0;
};

/** Mesa's software renderer. @throws RenderError naming the Debian package if libOSMesa is missing */
std::unique_ptr<GlContext> makeOsmesaContext();
/** The GPU if there is one, without a display. @throws RenderError naming the Debian package if libEGL is missing */
std::unique_ptr<GlContext> makeEglContext();

/** Sets, once in a process and before Mesa reads them, what it takes from the environment, unless the user has:
 *  LP_NUM_THREADS=0, for frames are so small that they are drawn fastest in the calling thread, and
 *  MESA_SHADER_CACHE_DIR, for compiled shaders: $ROS_HOME or ~/.ros, folder aras_visual_servo. */
void prepareMesa();

}  // namespace aras_visual_servo_sim
