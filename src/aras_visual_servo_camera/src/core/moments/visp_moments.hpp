#pragma once

#include <visp3/core/vpMomentAreaNormalized.h>
#include <visp3/core/vpMomentBasic.h>
#include <visp3/core/vpMomentCentered.h>
#include <visp3/core/vpMomentDatabase.h>
#include <visp3/core/vpMomentGravityCenter.h>
#include <visp3/core/vpMomentGravityCenterNormalized.h>
#include <visp3/core/vpMomentObject.h>

#include <vector>

namespace aras_visual_servo_camera {

/** A vpMomentObject whose moments are handed over: vpMomentObject::fromImage sums in an order that varies and assumes a
 *  constant pixel area. */
class HandedMomentObject : public vpMomentObject {
 public:
  explicit HandedMomentObject(int order) : vpMomentObject(static_cast<unsigned>(order)) { setType(DENSE_FULL_OBJECT); }
  /** @param m  the sequence of moments.hpp */
  void take(const std::vector<double>& m);
};

/** ViSP's moments of one object, computed in the order of their dependencies (ViSP leaves that to the caller). */
class VispMomentChain {
 public:
  explicit VispMomentChain(int order);

  /** Area, centroid and centred moments. */
  void update(const std::vector<double>& m);
  double xg() const { return gravity_.get()[0]; }
  double yg() const { return gravity_.get()[1]; }
  /** The sequence of moments.hpp. */
  std::vector<double> mu() const;

  struct Normalised {
    double xn, yn, an;
  };
  /** After update(). */
  Normalised normalised(double area_star, double z_star_m);

 private:
  int order_;
  HandedMomentObject object_;
  vpMomentDatabase database_;
  vpMomentBasic basic_;
  vpMomentGravityCenter gravity_;
  vpMomentCentered centred_;
  vpMomentAreaNormalized area_;
  vpMomentGravityCenterNormalized gravity_normalised_;
};

}  // namespace aras_visual_servo_camera
