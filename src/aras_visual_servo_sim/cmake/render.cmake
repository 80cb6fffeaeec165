# Cameras, scenes and rendering: OBJECT library sim_render. OSMesa is opened at run time (src/core/render/osmesa_library.cpp),
# so that its OpenGL never mixes with the libGL that OpenCV or ViSP bring along, and only its header is needed here.
find_package(assimp REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)
find_path(OSMESA_INCLUDE_DIR GL/osmesa.h REQUIRED)
find_library(STB_LIBRARY stb REQUIRED)  # reads PNG and JPEG: 0.5 MB, where OpenCV would load 150 libraries

file(GLOB render_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/../src/core/render/*.cpp)
add_library(sim_render OBJECT ${render_sources})
target_compile_options(sim_render PRIVATE -Wall -Wextra -Werror -fno-semantic-interposition)
# The same bytes from every build: no fused multiply-add, no reordering.
target_compile_options(sim_render PRIVATE -ffp-contract=off)
target_include_directories(sim_render PUBLIC ${CMAKE_CURRENT_LIST_DIR}/../include)
target_include_directories(sim_render SYSTEM PRIVATE ${OSMESA_INCLUDE_DIR})
target_link_libraries(sim_render PUBLIC Eigen3::Eigen yaml-cpp assimp::assimp ${STB_LIBRARY} ${CMAKE_DL_LIBS})
set_target_properties(sim_render PROPERTIES POSITION_INDEPENDENT_CODE ON)
