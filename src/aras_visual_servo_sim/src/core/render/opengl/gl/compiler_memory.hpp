#pragma once

namespace aras_visual_servo_sim {

/** Gives back what the last shaders that were compiled took of the process's memory: heap that is free again, and the
 *  pages of LLVM's library with its code and constants, some 45 MiB, which only compiling reads. The system keeps those
 *  of a library in its cache as long as it has room; whoever compiles next gets them back one by one. */
void giveBackCompilerMemory();

}  // namespace aras_visual_servo_sim
