# The front door: each verb sets up what it needs, then calls a preset of CMakePresets.json. `make` lists the verbs.
.DEFAULT_GOAL := help
JOBS ?= $(shell nproc)
MODULE ?=
FOLDER ?= ../shared/data/waypoints
PREFIX ?= /usr/local
SCENARIO := scenarios/box-demonstrator.yaml
SOURCES = $(shell find src apps bench tests examples python -name '*.hpp' -o -name '*.cpp' 2>/dev/null)

configure-build = cmake --preset $(1) $(2) && cmake --build --preset $(1) -j $(JOBS)
run-tests = ctest --preset $(1) -j $(JOBS)

.PHONY: help setup setup-test setup-program setup-python setup-lint setup-peers setup-package setup-fuzz setup-docs build demo test acceptance install python wheel package release reproducible check \
  format-check clang headers fix san san-fast tsan tidy cover fuzz same-bytes attack bench bench-peers figures pictures curves docs clean

help: ## list the verbs
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 22

setup: ## install the Debian and npm packages that are missing (root or sudo)
	@scripts/install-deps.sh && scripts/install-viewer.sh
setup-test:
	@scripts/install-deps.sh && scripts/install-viewer.sh --background
setup-program:
	@scripts/install-deps.sh program && scripts/install-viewer.sh --background
setup-python:
	@scripts/install-deps.sh python && scripts/install-viewer.sh --background
setup-lint:
	@scripts/install-deps.sh test lint && scripts/install-viewer.sh --background
setup-peers:
	@scripts/install-deps.sh python peers && scripts/install-viewer.sh --background && scripts/install-peers.sh build-bench/peers
setup-package:
	@scripts/install-deps.sh package && scripts/install-viewer.sh --background

setup-docs:
	@scripts/install-deps.sh docs

setup-fuzz:
	@scripts/install-deps.sh test fuzz && scripts/install-viewer.sh --background

build: setup-program ## build the program as build/snug
	@$(call configure-build,release,--log-level=WARNING)

demo: build ## pack the five sequences of the report as they come, and write a report of each
	@scripts/demo.sh

test: setup-test ## build and run every test; MODULE=cup for one module's
	@scripts/test.sh $(MODULE)

acceptance: build ## run the demonstrator's own programs in FOLDER, print the table of docs/trust.md
	@python3 tools/acceptance.py "$(FOLDER)"

python: setup-python ## build the Python module and install it: into VENV=DIR, else for /usr/bin/python3
	@cmake --preset release --log-level=WARNING && cmake --build --preset release -j $(JOBS) --target snug_python
	@scripts/install-python.sh build $(VENV)

wheel: setup-python ## make a wheel that needs nothing but numpy, and try it: build/wheel/snug-*.whl (build tools from PyPI)
	@JOBS=$(JOBS) scripts/make-wheel.sh

install: build ## install the program, its scenarios and the libraries under PREFIX (/usr/local)
	@cmake --install build --prefix "$(PREFIX)"

package: setup-package build ## make Debian packages of the program and of the libraries, and what they consist of (SPDX), in build/
	@export SOURCE_DATE_EPOCH="$${SOURCE_DATE_EPOCH:-$$(git log -1 --format=%ct 2>/dev/null || echo 0)}" && cd build && cpack -G DEB && \
	  python3 ../tools/sbom.py snug --version "$$(sed -n 's/^CMAKE_PROJECT_VERSION:.*=//p' CMakeCache.txt)" -o snug.spdx.json && echo "build/snug.spdx.json"

release: setup-package setup-python ## make packages, wheel, sources, notes and sums of the version that is tagged, in build/release
	@python3 tools/release.py

reproducible: setup-package setup-program ## build the packages twice, in different folders, and compare them byte by byte
	@python3 tools/reproducible.py

check: format-check test ## format check, warnings as errors, every test: before each push

format-check: setup-lint
	@clang-format --dry-run --Werror $(SOURCES)

clang: setup-lint ## a second compiler reads every source, each with its own includes only
	@$(call configure-build,clang)

headers: setup-program ## public headers that no source includes first compile alone
	@python3 -B tools/check_headers.py .

fix: setup-lint ## format every source, apply the safe clang-tidy fixes
	@clang-format -i $(SOURCES)
	@$(call configure-build,dev,-DSNUG_WERROR=OFF) && run-clang-tidy -quiet -fix -format -p build-dev -checks='-*,modernize-use-override,modernize-use-nullptr,modernize-use-using,readability-redundant-*,performance-move-const-arg'

san: setup-test ## tests under the address and undefined-behaviour sanitizers
	@$(call configure-build,asan) && $(call run-tests,asan)

san-fast: setup-test ## those of the modules that read files and move bodies
	@$(call configure-build,sanitize) && $(call run-tests,sanitize) --output-junit test-results.xml

tsan: setup-test ## tests under the thread sanitizer
	@$(call configure-build,tsan) && $(call run-tests,tsan)

fuzz: setup-fuzz ## attack every reader with libFuzzer for an hour; TIME=600 (seconds in all), READER=urdf for one
	@$(call configure-build,fuzz) && scripts/fuzz.sh build-fuzz "$(or $(TIME),3600)" $(READER)

same-bytes: setup-program setup-lint ## the same states by gcc and clang, -O1 and -O3, without AVX2 and FMA, on aarch64: VARIANTS="clang-O1 aarch64-gcc-O3"
	@python3 tools/same_bytes.py --jobs $(JOBS) $(VARIANTS)

attack: setup-test ## mutated files, strangers at every server, kills of every verb that writes, as often as COUNT says (1000)
	@$(call configure-build,release) && cmake --build --preset release -j $(JOBS) --target snug_tests && python3 tools/attack.py all $(or $(COUNT),1000)

tidy: setup-lint ## clang-tidy over everything
	@$(call configure-build,tidy)

cover: setup-test ## which lines the tests reach, by module
	@$(call configure-build,coverage) && $(call run-tests,coverage) && python3 tools/coverage.py build-coverage

bench: build ## how fast and how accurate the physics is, beside its targets
	@build/snug bench

bench-peers: setup-peers ## the same scenes in Bullet, MuJoCo, Drake, Rapier and Jolt, in one run; TOSSES=FILE.csv for tosses, an hour
	@$(call configure-build,bench) && build-bench/bench_peers \
	  $(if $(TOSSES),--tosses $(TOSSES) --engine snug --engine bullet-si10 --engine mujoco-elliptic-stiff)

figures: build ## make the numbers that README and the documents state, and write them there, hours; NAME="camera tosses" for some, NAME=--list for all names
	@cmake --build --preset release -j $(JOBS) --target cup_test motion_test physics_test
	@python3 tools/figures.py $(NAME)
	@/usr/bin/python3 tools/charts.py

pictures: build setup-test ## draw the pictures of the documents that show runs and pages, some minutes; NAME="report kitchen"
	@python3 tools/pictures.py $(NAME)

curves: ## draw the pictures of docs/theory that show computed curves, some seconds; NAME="cup-rest"
	@python3 tools/theory_pictures.py $(NAME)

docs: setup-docs build ## check every link of the documents, build the documentation site with every verb's options: build/site/index.html; after make demo with a gallery
	@python3 tools/check_docs.py . && python3 tools/build_site.py build/site

clean: ## remove what the verbs built
	@rm -rf build build-dev build-asan build-clang build-sanitize build-tsan build-tidy build-coverage build-bench build-fuzz build-same out
