#include "scene_markers.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "convert/conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kBoardGapM = 0.0005;  // so that the board does not flicker through what lies on it in rviz
constexpr float kColorScale = 1.0F / 255.0F;

std_msgs::ColorRGBA colorOf(Rgb color) {
  std_msgs::ColorRGBA result;
  result.r = kColorScale * color.r;
  result.g = kColorScale * color.g;
  result.b = kColorScale * color.b;
  result.a = 1.0F;
  return result;
}

visualization_msgs::Marker emptyMarker(const std::string& model, const Pose& X_WM, int id, Rgb color) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = kWorldFrame;  // stamp zero: always drawn with the latest transform
  marker.ns = model;
  marker.id = id;
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose = toMessage(X_WM);
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = colorOf(color);
  return marker;
}

void addPoint(visualization_msgs::Marker& marker, const Eigen::Vector2d& corner, double z_m) {
  geometry_msgs::Point point;
  point.x = corner.x();
  point.y = corner.y();
  point.z = z_m;
  marker.points.push_back(point);
}

void addPlanar(const PlanarModel& model, std::vector<visualization_msgs::Marker>& markers) {
  if (model.picture()) {  // as a rectangle of its mean colour: markers have no pictures
    markers.push_back(emptyMarker(model.name(), model.X_WM, 2, model.picture()->texture->meanColor()));
    const Polygon corners = model.pictureCorners();
    for (const std::size_t k : {0, 1, 2, 0, 2, 3}) addPoint(markers.back(), corners[k], -0.5 * kBoardGapM);
  }
  if (model.board()) {
    markers.push_back(emptyMarker(model.name(), model.X_WM, 0, model.board()->color));
    const Polygon corners = model.boardCorners();
    for (const std::size_t k : {0, 1, 2, 0, 2, 3}) addPoint(markers.back(), corners[k], -kBoardGapM);
  }
  visualization_msgs::Marker shape = emptyMarker(model.name(), model.X_WM, 1, model.color());
  for (std::size_t k = 0; k < model.outlines().size(); ++k) {
    for (const auto& triangle : model.triangles(k)) {
      for (const std::uint32_t corner : triangle) addPoint(shape, model.outlines()[k][corner], 0.0);
    }
  }
  if (!shape.points.empty()) markers.push_back(std::move(shape));
}

void addSolid(const Body& body, std::vector<visualization_msgs::Marker>& markers) {
  for (std::size_t k = 0; k < body.shapes.size(); ++k) {
    const Shape& shape = body.shapes[k];
    markers.push_back(emptyMarker(body.name, body.X_WB * shape.X_BS, static_cast<int>(k), shape.color));
    for (const auto& triangle : shape.mesh->triangles) {
      for (const std::uint32_t corner : triangle) {
        const Eigen::Vector3f& p = shape.mesh->points[corner];
        addPoint(markers.back(), p.head<2>().cast<double>(), p.z());
        if (!shape.mesh->colors.empty()) markers.back().colors.push_back(colorOf(shape.mesh->colors[corner]));
      }
    }
  }
}

}  // namespace

visualization_msgs::MarkerArray sceneMarkers(const Simulation& simulation) {
  visualization_msgs::MarkerArray markers;
  markers.markers.emplace_back();
  markers.markers.back().header.frame_id = kWorldFrame;
  markers.markers.back().action = visualization_msgs::Marker::DELETEALL;  // some models may have been removed
  for (const PlanarModel& model : simulation.scene().models) {
    if (model.visible) addPlanar(model, markers.markers);
  }
  const std::vector<std::string> models = simulation.models().names();
  for (const Body& body : simulation.scene().bodies) {
    const bool solid = std::find(models.begin(), models.end(), body.name) != models.end();  // no link of the robot
    if (solid && body.visible) addSolid(body, markers.markers);
  }
  return markers;
}

SceneMarkers::SceneMarkers(ros::NodeHandle& node, const Simulation& simulation)
    : simulation_(simulation), publisher_(node.advertise<visualization_msgs::MarkerArray>("scene_markers", 1, true)) {}

void SceneMarkers::publish() { publisher_.publish(sceneMarkers(simulation_)); }

void SceneMarkers::refresh() {
  if (publisher_.getNumSubscribers() > 0) publish();
}

}  // namespace aras_visual_servo_sim
