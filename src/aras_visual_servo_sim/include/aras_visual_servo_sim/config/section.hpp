#pragma once

#include <aras_visual_servo_common/text.hpp>
#include <string>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

using aras_visual_servo_common::FaultList;
using aras_visual_servo_common::joined;
using aras_visual_servo_common::numberText;
using aras_visual_servo_common::readSection;
using aras_visual_servo_common::Schema;
using aras_visual_servo_common::SectionCheck;

/** A section of this package's folder `schema`, the only place where types, ranges, choices and defaults of its keys
 *  stand. @param name  name of its file without .yaml @throws UnknownNameError */
inline const Schema& sectionOf(const std::string& name) { return schemaSections().section(name); }

/** Checks a value that does not come from YAML against what a section says about its key; adds a fault. */
void checkValue(const Schema& section, const std::string& key, const YAML::Node& value, FaultList& faults);
void checkValue(const Schema& section, const std::string& key, double value, FaultList& faults);
void checkValue(const Schema& section, const std::string& key, const std::string& value, FaultList& faults);
void checkValue(const Schema& section, const std::string& key, const std::vector<double>& values, FaultList& faults);

/** The pose that the keys position_m and rpy_rad of a section give. */
template <typename Settings>
Pose poseOf(const Settings& settings) {
  return {settings.position_m, quaternionFromRpy(settings.rpy_rad)};
}

/** Checks a pose that somebody asks for: its position as the section solid has it, its quaternion of a length that can
 * be made 1. @param what  names it in messages @throws NotFiniteError, ParameterError */
void checkPlace(const std::string& what, const Pose& pose);

}  // namespace aras_visual_servo_sim
