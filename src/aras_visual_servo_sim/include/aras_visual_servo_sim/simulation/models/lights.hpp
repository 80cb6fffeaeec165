#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

namespace aras_visual_servo_sim {

/** @param links  of all robots
 *  @throws ParameterError naming a light that is attached to neither a link nor a model, or that is there twice, or
 *  their number if there are too many */
void checkLights(const ModelSet& set, const std::vector<std::string>& links);

/** The set with this light, in the place of that of the same name if there is one. @throws as checkLights */
ModelSet withLight(const ModelSet& set, const Light& light, const std::vector<std::string>& links);

/** The light of this name. @throws UnknownNameError naming the lights there are */
const Light& lightOf(const ModelSet& set, const std::string& name);

/** The set without the light of this name. @throws as lightOf */
ModelSet withoutLight(const ModelSet& set, const std::string& name);

}  // namespace aras_visual_servo_sim
