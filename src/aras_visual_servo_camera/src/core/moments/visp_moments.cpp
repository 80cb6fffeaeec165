#include "moments/visp_moments.hpp"

#include "aras_visual_servo_camera/moments/moments.hpp"

namespace aras_visual_servo_camera {

void HandedMomentObject::take(const std::vector<double>& m) {
  for (unsigned n = 0; n <= getOrder(); ++n)
    for (unsigned j = 0; j <= n; ++j) set(n - j, j, m[momentIndex(static_cast<int>(n - j), static_cast<int>(j))]);
}

VispMomentChain::VispMomentChain(int order) : order_(order), object_(order), area_(1.0, 1.0) {
  for (vpMoment* moment : std::initializer_list<vpMoment*>{&basic_, &gravity_, &centred_, &area_, &gravity_normalised_})
    moment->linkTo(database_);
}

void VispMomentChain::update(const std::vector<double>& m) {
  object_.take(m);
  database_.updateAll(object_);
  basic_.compute();
  gravity_.compute();
  centred_.compute();
}

std::vector<double> VispMomentChain::mu() const {
  std::vector<double> mu;
  for (int n = 0; n <= order_; ++n)
    for (int j = 0; j <= n; ++j) mu.push_back(centred_.get(static_cast<unsigned>(n - j), static_cast<unsigned>(j)));
  return mu;
}

VispMomentChain::Normalised VispMomentChain::normalised(double area_star, double z_star_m) {
  area_.setDesiredArea(area_star);
  area_.setDesiredDepth(z_star_m);  // ViSP's default of 1 would scale all three by 1 / Z*
  area_.compute();
  gravity_normalised_.compute();
  return {gravity_normalised_.get()[0], gravity_normalised_.get()[1], area_.get()[0]};
}

}  // namespace aras_visual_servo_camera
