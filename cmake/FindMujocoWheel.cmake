# MuJoCo out of an installed mujoco wheel: sandwright::mujoco.
execute_process(
  COMMAND ${SANDWRIGHT_PYTHON} -c
          "import importlib.util as u; print(u.find_spec('mujoco').submodule_search_locations[0])"
  OUTPUT_VARIABLE mujoco_root OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE mujoco_missing ERROR_QUIET)
if(mujoco_missing)
  message(FATAL_ERROR "no mujoco in ${SANDWRIGHT_PYTHON}: run `make setup`, or name another Python "
                      "with -DSANDWRIGHT_PYTHON=...")
endif()
# Not cached: another SANDWRIGHT_PYTHON must not link the library of the one before.
find_library(mujoco_library NAMES libmujoco.so.4.0.0 PATHS ${mujoco_root} NO_DEFAULT_PATH NO_CACHE)
if(NOT mujoco_library)
  message(FATAL_ERROR "no libmujoco.so.4.0.0 in ${mujoco_root}: requirements.txt names the version")
endif()
add_library(sandwright_mujoco INTERFACE)
target_include_directories(sandwright_mujoco SYSTEM INTERFACE ${mujoco_root}/include)
target_link_libraries(sandwright_mujoco INTERFACE ${mujoco_library})
target_link_options(sandwright_mujoco INTERFACE "LINKER:-rpath,${mujoco_root}")
add_library(sandwright::mujoco ALIAS sandwright_mujoco)
message(STATUS "mujoco: ${mujoco_library}")
