# MuJoCo out of an installed mujoco wheel: sandwright::mujoco.
execute_process(
  COMMAND ${SANDWRIGHT_PYTHON} -c
          "import importlib.util as u; print(u.find_spec('mujoco').submodule_search_locations[0])"
  OUTPUT_VARIABLE mujoco_root OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE mujoco_missing ERROR_QUIET)
if(mujoco_missing)
  message(FATAL_ERROR "no mujoco in ${SANDWRIGHT_PYTHON}: run `make setup`, or name another Python "
                      "with -DSANDWRIGHT_PYTHON=...")
endif()
find_library(MUJOCO_LIBRARY NAMES libmujoco.so.4.0.0 PATHS ${mujoco_root} NO_DEFAULT_PATH REQUIRED)
add_library(sandwright_mujoco INTERFACE)
target_include_directories(sandwright_mujoco SYSTEM INTERFACE ${mujoco_root}/include)
target_link_libraries(sandwright_mujoco INTERFACE ${MUJOCO_LIBRARY})
target_link_options(sandwright_mujoco INTERFACE "LINKER:-rpath,${mujoco_root}")
add_library(sandwright::mujoco ALIAS sandwright_mujoco)
message(STATUS "mujoco: ${MUJOCO_LIBRARY}")
