# The front door. `make demo` and `make test` do all the set-up themselves on a fresh Debian 12 or
# Ubuntu; a second call rebuilds nothing. `cmake --preset release` works without this file.
#
#   make PYTHON=/path/to/python   links the torch and mujoco of that Python instead of .venv's

PYTHON ?= .venv/bin/python
PRESET ?= release
JOBS ?= $(shell nproc)

.PHONY: setup lammps build test demo clean
.DEFAULT_GOAL := build

# Debian packages that are missing (sudo where not root), then the pinned wheels.
setup:
	@./setup.sh $(PYTHON)

# Optional: the engine of the sand model `dem`. Without it that model says so, and its tests are skipped.
lammps:
	@./setup.sh $(PYTHON) packages-dem.txt

build: setup
	@cmake --preset $(PRESET) -DSANDWRIGHT_PYTHON=$(abspath $(shell command -v $(PYTHON))) $(CMAKE_FLAGS) --log-level=NOTICE
	@cmake --build --preset $(PRESET) -j $(JOBS)

test: build
	@ctest --preset $(PRESET) -j $(JOBS)

demo: build
	@build/sandwright demo --out demo_out

clean:
	rm -rf build
