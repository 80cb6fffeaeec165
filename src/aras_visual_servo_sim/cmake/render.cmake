# Cameras, scenes and rendering: OBJECT library sim_render. No graphics library.
find_package(assimp REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)
find_library(STB_LIBRARY stb REQUIRED)  # reads PNG and JPEG: 0.5 MB, where OpenCV would load 150 libraries

file(GLOB render_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/../src/core/render/*.cpp)
add_library(sim_render OBJECT ${render_sources})
target_compile_options(sim_render PRIVATE -Wall -Wextra -Werror -fno-semantic-interposition)
# The same bytes from every build: no fused multiply-add, no reordering.
target_compile_options(sim_render PRIVATE -ffp-contract=off)
target_include_directories(sim_render PUBLIC ${CMAKE_CURRENT_LIST_DIR}/../include)
target_link_libraries(sim_render PUBLIC Eigen3::Eigen yaml-cpp assimp::assimp ${STB_LIBRARY})
set_target_properties(sim_render PROPERTIES POSITION_INDEPENDENT_CODE ON)
