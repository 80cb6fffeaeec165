// Bullet's own inline functions, compiled once more. Its library holds some of them as functions that call other small
// functions, down to single products of matrices. Emitted here, where the compiler puts one into the other, they take
// two thirds of the instructions, and the dynamic linker gives them to Bullet's library too, because it searches this
// one first. The source is the same, so the results are the same; should the linker find the others, only time is lost.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <LinearMath/btSpatialAlgebra.h>

namespace aras_visual_servo_sim {

/** Functions that are emitted because their addresses are taken. */
struct Emitted {
  /** The inertia of a link and what it carries, in the frame of its parent. */
  void (btSpatialTransformationMatrix::*transform)(const btSymmetricSpatialDyad&, btSymmetricSpatialDyad&,
                                                   btSpatialTransformationMatrix::eOutputOperation);
  /** Where a link is, from the position of its joint. */
  void (btMultibodyLink::*place)(btScalar*);
};
extern const Emitted kEmitted;
const Emitted kEmitted{&btSpatialTransformationMatrix::transformInverse, &btMultibodyLink::updateCacheMultiDof};

}  // namespace aras_visual_servo_sim
