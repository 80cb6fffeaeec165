# aras_install_programs(FILE ...): installs Python programs that run with the interpreter this workspace is built for,
# whatever comes first in the PATH of who starts them. catkin_install_python leaves `env python3` as it stands, and
# `env` takes the python3 of a pyenv or conda, which has neither rospy nor the numpy of our C++ modules.
function(aras_install_programs)
  set(destination ${CATKIN_PACKAGE_BIN_DESTINATION})
  if(ARAS_PROGRAMS_DESTINATION)
    set(destination ${ARAS_PROGRAMS_DESTINATION})
  endif()
  foreach(source IN LISTS ARGN)
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(name ${source} NAME)
    set(program ${CMAKE_CURRENT_BINARY_DIR}/programs/${name})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    file(READ ${source} text)
    string(REGEX REPLACE "^#!/usr/bin/env python3\n" "#!${PYTHON_EXECUTABLE}\n" text "${text}")
    file(COPY ${source} DESTINATION ${CMAKE_CURRENT_BINARY_DIR}/programs)  # with its permissions
    file(WRITE ${program} "${text}")
    catkin_install_python(PROGRAMS ${program} DESTINATION ${destination})
  endforeach()
endfunction()
