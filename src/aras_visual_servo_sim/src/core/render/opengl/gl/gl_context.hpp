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
  /** What draws, and of which version: "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa ...", followed by
   * ", through EGL" where it is not OSMesa. @pre bound */
  std::string description() const;

 protected:
  GlFunctions gl_;
  std::string through_;  ///< the end of the description

 private:
  virtual void bind() = 0;
  virtual void release() = 0;
};

/** Mesa's software renderer: OSMesa, or through EGL where libOSMesa is missing. @throws RenderError naming the Debian
 * packages if both are missing */
std::unique_ptr<GlContext> makeOsmesaContext();
/** The GPU if there is one, without a display. @throws RenderError naming the Debian package if libEGL is missing */
std::unique_ptr<GlContext> makeEglContext();

/** Gives back what the last shaders that were compiled took of the process's memory: heap that is free again, and the
 *  pages of LLVM's library with its code and constants, some 45 MiB, which only compiling reads. The system keeps those
 *  of a library in its cache as long as it has room; whoever compiles next gets them back one by one. */
void giveBackCompilerMemory();

}  // namespace aras_visual_servo_sim
