# libtorch out of an installed torch wheel: sandwright::torch.
# Torch's own CMake package fails for a CUDA build where no CUDA toolkit is installed, so the
# folders are looked up directly; a CPU build and any CUDA build link alike.
execute_process(
  COMMAND ${SANDWRIGHT_PYTHON} -c
          "import importlib.util as u; print(u.find_spec('torch').submodule_search_locations[0])"
  OUTPUT_VARIABLE torch_root OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE torch_missing ERROR_QUIET)
if(torch_missing)
  message(FATAL_ERROR "no torch in ${SANDWRIGHT_PYTHON}: run `make setup`, or name another Python "
                      "with -DSANDWRIGHT_PYTHON=...")
endif()

add_library(sandwright_torch INTERFACE)
# Behind the system's own folders: the wheel carries a copy of fmt that is not spdlog's.
target_compile_options(sandwright_torch INTERFACE "SHELL:-idirafter ${torch_root}/include"
  "SHELL:-idirafter ${torch_root}/include/torch/csrc/api/include")
target_link_directories(sandwright_torch INTERFACE ${torch_root}/lib)
target_link_options(sandwright_torch INTERFACE "LINKER:-rpath,${torch_root}/lib")
target_link_libraries(sandwright_torch INTERFACE torch torch_cpu c10)
if(EXISTS ${torch_root}/lib/libtorch_cuda.so)
  # No symbol of it is named by our code: it registers its kernels when it is loaded.
  file(GLOB cuda_folders ${torch_root}/../nvidia/*/lib)
  foreach(folder ${cuda_folders})
    target_link_options(sandwright_torch INTERFACE "LINKER:-rpath-link,${folder}")
  endforeach()
  target_link_libraries(sandwright_torch INTERFACE
    -Wl,--push-state,--no-as-needed torch_cuda c10_cuda -Wl,--pop-state)
endif()
add_library(sandwright::torch ALIAS sandwright_torch)
message(STATUS "torch: ${torch_root}")
