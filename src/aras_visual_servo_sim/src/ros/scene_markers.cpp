#include "scene_markers.hpp"

#include <utility>

#include "conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kBoardGapM = 0.0005;  // keeps the board from flickering through what is before it in rviz
constexpr float kColorScale = 1.0F / 255.0F;

visualization_msgs::Marker emptyMarker(const PlanarModel& model, const std::string& world_frame, int id, Rgb color) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = world_frame;  // stamp zero: always drawn with the latest transform
  marker.ns = model.name();
  marker.id = id;
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose = toMessage(model.X_WM);
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = kColorScale * color.r;
  marker.color.g = kColorScale * color.g;
  marker.color.b = kColorScale * color.b;
  marker.color.a = 1.0F;
  return marker;
}

void addPoint(visualization_msgs::Marker& marker, const Eigen::Vector2d& corner, double z_m) {
  geometry_msgs::Point point;
  point.x = corner.x();
  point.y = corner.y();
  point.z = z_m;
  marker.points.push_back(point);
}

}  // namespace

visualization_msgs::MarkerArray sceneMarkers(const Scene& scene, const std::string& world_frame) {
  visualization_msgs::MarkerArray markers;
  markers.markers.emplace_back();
  markers.markers.back().header.frame_id = world_frame;
  markers.markers.back().action = visualization_msgs::Marker::DELETEALL;  // models may have gone
  for (const PlanarModel& model : scene.models) {
    if (!model.visible) continue;
    if (model.picture()) {  // as a rectangle of its mean colour: markers have no pictures
      visualization_msgs::Marker picture = emptyMarker(model, world_frame, 2, model.picture()->texture->meanColor());
      const Polygon corners = model.pictureCorners();
      for (const std::size_t k : {0, 1, 2, 0, 2, 3}) addPoint(picture, corners[k], -0.5 * kBoardGapM);
      markers.markers.push_back(picture);
    }
    if (model.board()) {
      visualization_msgs::Marker board = emptyMarker(model, world_frame, 0, model.board()->color);
      const Polygon corners = model.boardCorners();
      for (const std::size_t k : {0, 1, 2, 0, 2, 3}) addPoint(board, corners[k], -kBoardGapM);
      markers.markers.push_back(board);
    }
    visualization_msgs::Marker shape = emptyMarker(model, world_frame, 1, model.color());
    for (std::size_t k = 0; k < model.outlines().size(); ++k) {
      for (const auto& triangle : model.triangles(k)) {
        for (const std::uint32_t corner : triangle) addPoint(shape, model.outlines()[k][corner], 0.0);
      }
    }
    if (!shape.points.empty()) markers.markers.push_back(shape);
  }
  return markers;
}

SceneMarkers::SceneMarkers(ros::NodeHandle& node, std::string world_frame)
    : world_frame_(std::move(world_frame)),
      publisher_(node.advertise<visualization_msgs::MarkerArray>("scene_markers", 1, true)) {}

void SceneMarkers::publish(const Scene& scene) { publisher_.publish(sceneMarkers(scene, world_frame_)); }

}  // namespace aras_visual_servo_sim
