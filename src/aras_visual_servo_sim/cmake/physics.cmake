# Robot model, joint controllers and articulated-body dynamics: no ROS, no graphics.
find_package(Eigen3 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(SIM_PHYSICS REQUIRED bullet-float64 urdfdom yaml-cpp console_bridge tinyxml2)

add_library(sim_physics OBJECT
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/articulated_body.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/articulated_body_bullet.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/contact_config.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/contact_island.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/contact_points.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/contact_shapes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/contact_solver.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/floating_base.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/camera_sensor.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/gazebo_materials.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/free_body.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_controller.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_coupling.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_drive.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_graph.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_limits.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_limits_reader.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_state_config.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/joint_solver.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/multibody_world.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/pid.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/robot_model.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/urdf_check.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/urdf_extensions.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/urdf_loader.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/urdf_text.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/urdf_mimic.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/world_contacts.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/world_impl.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/world_state.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../src/core/physics/yaml_reader.cpp)
set_target_properties(sim_physics PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON
                                             CXX_EXTENSIONS OFF)
target_include_directories(sim_physics PUBLIC ${CMAKE_CURRENT_LIST_DIR}/../include)
target_include_directories(sim_physics SYSTEM PUBLIC ${EIGEN3_INCLUDE_DIRS} ${SIM_PHYSICS_INCLUDE_DIRS})
# Bullet's headers are right only with the precision its library was built with: for all who see them.
target_compile_definitions(sim_physics PUBLIC BT_USE_DOUBLE_PRECISION)
target_compile_options(sim_physics PRIVATE -Wall -Wextra -Werror -fno-semantic-interposition)
# The same bytes on every run and every x86-64: no contraction into fused multiply-add.
target_compile_options(sim_physics PRIVATE -ffp-contract=off)
target_link_libraries(sim_physics PUBLIC ${SIM_PHYSICS_LINK_LIBRARIES})
