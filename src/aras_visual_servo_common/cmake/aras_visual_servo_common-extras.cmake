# For packages that depend on aras_visual_servo_common: the target to link with, the flags to compile with, also in a build
# under sanitizers, and the schema sections in a library.
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)

if(NOT TARGET aras_visual_servo_common::aras_visual_servo_common)
  add_library(aras_visual_servo_common::aras_visual_servo_common INTERFACE IMPORTED)
  set_target_properties(aras_visual_servo_common::aras_visual_servo_common PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${aras_visual_servo_common_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "${aras_visual_servo_common_LIBRARIES};yaml-cpp;Eigen3::Eigen")
endif()

# What everything of ours is compiled with. GCC would look through its memory for what it no longer needs, and precompiled
# headers are most of that memory. Not before it holds 512 MB, given in kB: that takes an eighth off the time of most files.
set(aras_compile_options -Wall -Wextra -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND aras_compile_options --param=ggc-min-heapsize=524288)
endif()

# What a build with ARAS_SANITIZE compiles and links with. The checks that are left out take two fifths of the time of that
# build: those of null and of bounds at each access, which the address sanitizer makes, those of virtual tables, and those
# of alignment at each access, for which the compiler refuses every cast to a type that asks for more of it. The programs
# of script/fuzz check alignment as they run. Only without sanitizers is GCC right about what may be uninitialised.
set(aras_sanitizers -fsanitize=address,undefined -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer -Wcast-align=strict -Wno-maybe-uninitialized)

# aras_folders_as_one(TARGET SOURCES [ALONE REGEX]): the SOURCES of a folder are compiled as one file, which takes two fifths
# off the time of a build. So no two files of a folder may define the same name in an unnamed namespace, except files whose
# paths match REGEX, which are compiled by themselves. Without ARAS_FOLDERS_AS_ONE an edit compiles one file only.
option(ARAS_FOLDERS_AS_ONE "Compile the sources of a folder as one file" ON)
function(aras_folders_as_one target sources)
  cmake_parse_arguments(PARSE_ARGV 2 arguments "" "ALONE" "")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ARAS_FOLDERS_AS_ONE} UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ${sources})
    if(NOT arguments_ALONE OR NOT source MATCHES "${arguments_ALONE}")
      # Relative, so that the name of the workspace's folder is in no object file.
      get_filename_component(folder ${source} ABSOLUTE)
      file(RELATIVE_PATH folder ${CMAKE_CURRENT_SOURCE_DIR} ${folder})
      get_filename_component(folder ${folder} DIRECTORY)
      string(MAKE_C_IDENTIFIER ${folder} folder)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
    endif()
  endforeach()
endfunction()

# aras_embed_schema(TARGET FOLDER): puts each FOLDER/NAME.yaml into TARGET, a library, and generates a settings struct
# for each map that these sections describe. Sources of TARGET and of what links it then find
#   #include "PROJECT_NAME/config/sections.hpp"
set(aras_generate_sections ${CMAKE_CURRENT_LIST_DIR}/generate_sections.py)
function(aras_embed_schema target folder)
  get_filename_component(folder ${folder} ABSOLUTE)
  file(GLOB sections CONFIGURE_DEPENDS ${folder}/*.yaml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${sections} ${aras_generate_sections})
  set(include ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_INCLUDE_DESTINATION})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/sections.cpp)
  execute_process(RESULT_VARIABLE failed
    COMMAND ${PYTHON_EXECUTABLE} ${aras_generate_sections} ${PROJECT_NAME} ${folder} ${include}/${PROJECT_NAME}/config/sections.hpp
      ${source})
  if(failed)
    message(FATAL_ERROR "aras_embed_schema: ${folder} has the faults above")
  endif()
  target_sources(${target} PRIVATE ${source})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${include}>)
  install(FILES ${include}/${PROJECT_NAME}/config/sections.hpp DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION}/config)
endfunction()

# aras_fuzz_targets(LIBRARY FOLDER): each FOLDER/NAME.cpp becomes a program fuzz_NAME, which feeds a reader of LIBRARY with
# what clang's libFuzzer makes up. script/fuzz compiles with the sanitizers that such programs need.
function(aras_fuzz_targets library folder)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ARAS_FUZZ: found the compiler ${CMAKE_CXX_COMPILER_ID}, allowed Clang, which has libFuzzer")
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME_WE)
    add_executable(fuzz_${name} ${source})
    target_link_libraries(fuzz_${name} PRIVATE ${library} ${ARGN})
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
    set_target_properties(fuzz_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/fuzz)
  endforeach()
endfunction()
