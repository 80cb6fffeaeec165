#pragma once

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

/** A colour of red, green and blue, 0 .. 255, rounded to bytes. */
Rgb colorOf(const Eigen::Vector3d& rgb);

/** What sections give, and what their schemas cannot express. */
Light lightOf(const LightConfig& settings);
void checkLight(const LightConfig& settings, const SectionCheck& section);
Lighting lightingOf(const LightingConfig& settings);
Material materialOf(const MaterialConfig& settings);

/** What a flat model looks like, by the keys of a model or of a target file. */
template <typename Settings>
PlanarShape planarShapeOf(const Settings& settings) {
  PlanarShape shape;
  shape.color = colorOf(settings.color_rgb);
  shape.outlines = settings.outlines_m.value_or(std::vector<Polygon>());
  if (settings.board) shape.board = PlanarModel::Board{settings.board->size_m, colorOf(settings.board->color_rgb)};
  if (settings.image) shape.picture = PlanarShape::PictureFile{settings.image->file, settings.image->size_m};
  return shape;
}

}  // namespace aras_visual_servo_sim
