# The commands for somebody who has just cloned hyperiso. On Debian and Ubuntu each installs the packages it
# lacks (tools/install_dependencies); README.md lists them for other systems. Developers may as well use the
# cmake presets directly: see CONTRIBUTING.md.

processors := $(shell getconf _NPROCESSORS_ONLN)

.PHONY: help demo build test bench clean

help:
	@echo "make demo    the main job on a bundled simulation; the results go to demo/"
	@echo "make build   the optimised program: build/release/bin/hyperiso"
	@echo "make test    builds everything and runs the tests"
	@echo "make bench   what extraction costs, beside the memory's limit and other programs (docs/performance.md)"
	@echo "make clean   removes what the others made"

build:
	@tools/install_dependencies build
	cmake --preset release -D HYPERISO_BUILD_TESTS=OFF
	cmake --build --preset release

demo:
	@tools/install_dependencies build demo
	@$(MAKE) --no-print-directory build
	@examples/demo build/release/bin/hyperiso demo

test:
	@tools/install_dependencies build test
	cmake --preset release
	cmake --build --preset release
	ctest --preset release --parallel $(processors)

bench:
	@tools/install_dependencies build bench
	cmake --preset release -D HYPERISO_BUILD_BENCH=ON
	cmake --build --preset release --target hyperiso_bench
	@build/release/bin/hyperiso_bench

clean:
	rm -rf build demo
