# SPDX-License-Identifier: MIT
# iftty: segment 3-D scenes by seeds, in a terminal.  `make help` lists the targets.

CC       ?= cc
CXX      ?= c++
VARIANT  ?= release
OPTIMISE ?= -O2
SANITISE ?=
PREFIX   ?= /usr/local
BUILD    := $(if $(filter release,$(VARIANT)),build,build/$(VARIANT))

PACKAGES := g++ pkg-config libopenimageio-dev libopenexr-dev nettle-dev zlib1g-dev libdeflate-dev \
            openexr openimageio-tools
# Packaged for amd64, arm64 and a few more; without it gzip files are read at a third of the speed.
INFLATER := libisal-dev
# For iftty-volume and iftty-register alone; `make demo` does not wait for them.
VOLUME_PACKAGES := libinsighttoolkit5-dev libgdcm-dev libhdf5-dev libtiff-dev libexpat1-dev
SCENES   := mricron-data
LESSONS  := invesalius-examples insighttoolkit5-examples
# Packages of tests. Those after this word in a list are left out where they do not exist.
TEST_PACKAGES := tmux screen procps python3 python3-nibabel python3-pydicom python3-h5py \
                 python3-jsonschema python3-matplotlib \
                 teem-apps dcmtk dicom3tools medcon plastimatch libinsighttoolkit5-dev \
                 python3-tifffile libtiff-tools openssh-client \
                 bindfs fuse3 python3-pil python3-fonttools fonts-dejavu-extra \
                 man-db groff-base mandoc zsh fish
# Debian 13 has the HEIC encoder in a separate package.
HEIC           = $(shell apt-cache show libheif-plugin-x265 >/dev/null 2>&1 && \
                     echo libheif-plugin-x265)
FORMATTER     := clang-format-14
BARE_PACKAGES := autopkgtest debootstrap
DEB_PACKAGES  := build-essential debhelper lintian
OCI_PACKAGES  := umoci crun
# For `make static`; for another machine, its cross compiler and an emulator.
CROSS_amd64     := gcc-x86-64-linux-gnu
CROSS_arm64     := gcc-aarch64-linux-gnu
STATIC_PACKAGES  = dpkg-dev $(if $(filter-out $(NATIVE),$(ARCH)),$(CROSS_$(ARCH)) qemu-user-static)
# Other versions of clang-tidy have other findings.
ANALYSERS     := cppcheck clang-tidy-14

# Other versions of clang-format format differently.
FORMAT    = $(firstword $(shell which $(FORMATTER) 2>/dev/null) clang-format)
FORMATTED = $(shell find src journal render tui tests examples -name '*.[ch]' -o -name '*.cc' \
                -o -name '*.hh')

# Hardening of code that reads files of strangers. Sanitisers check more than that, and
# _FORTIFY_SOURCE does not work with -O0.
MACHINE   := $(shell $(CC) -dumpmachine 2>/dev/null)
HARDENED   = $(if $(SANITISE)$(filter -O0,$(OPTIMISE)),,-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3) \
             -fstack-protector-strong -fstack-clash-protection -fPIE \
             $(if $(filter x86_64-%,$(MACHINE)),-fcf-protection)
HARD_LINKS = -pie -Wl,-z,relro,-z,now,-z,noexecstack

# Reproducible in any folder (tests/test_reproducible.sh).
ANYWHERE   = '-ffile-prefix-map=$(CURDIR)=.'

# Warnings are errors where code is tested (.ci/run, `make tests`), since compilers differ in them.
# Only static functions pass vectors, so no ABI is affected on machines without vector registers.
WERROR   ?= $(if $(filter tests,$(MAKECMDGOALS)),-Werror)
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wvla -Wno-psabi \
            -Wno-enum-float-conversion $(WERROR)
STRICT_C := -Wstrict-prototypes -Wmissing-prototypes
INCLUDES := -Isrc -I.
COMMON    = $(OPTIMISE) $(HARDENED) $(SANITISE) -g $(ANYWHERE) -ffp-contract=off $(WARNINGS) \
            $(INCLUDES) -MMD -MP
ALL_CFLAGS   = -std=c17 -D_GNU_SOURCE $(COMMON) $(STRICT_C) $(EXR_CFLAGS) $(CFLAGS)
ALL_CXXFLAGS = -std=c++17 $(COMMON) -idirafter $(OIIO_INCLUDE) $(CXXFLAGS)
ALL_LDFLAGS  = $(HARD_LINKS) $(SANITISE) $(LDFLAGS)

EXR_CFLAGS   = $(shell pkg-config --cflags OpenEXR 2>/dev/null)
OIIO_INCLUDE = $(shell pkg-config --variable=includedir OpenImageIO 2>/dev/null || \
                   echo /usr/include)
OIIO_LIBS    = $(shell pkg-config --libs OpenImageIO 2>/dev/null)
LIBS         = -lOpenEXRCore -lz -ldeflate $(if $(wildcard /usr/include/isa-l/igzip_lib.h),-lisal) \
               -lnettle -lm

# `make static` for ARCH, of this machine or another: its compiler, and Debian's libraries for it in
# the build folder, so that no library of the machine is used (.package/libraries).
NATIVE := $(shell dpkg --print-architecture 2>/dev/null)
ARCH   ?= $(NATIVE)
STATIC  = static$(if $(filter-out $(NATIVE),$(ARCH)),-$(ARCH))
FROM    = build/$(STATIC)/from
ifeq ($(VARIANT),$(STATIC))
MACHINE     := $(shell dpkg-architecture -a$(ARCH) -qDEB_HOST_MULTIARCH)
override CC := $(filter %ccache,$(CC)) $(MACHINE)-gcc '--sysroot=$(CURDIR)/$(FROM)/root' \
               '-B$(CURDIR)/$(FROM)/root/usr/lib/$(MACHINE)'
override AR := $(MACHINE)-ar
EXR_CFLAGS   = -isystem =/usr/include/OpenEXR -isystem =/usr/include/Imath
HARD_LINKS   = -static-pie -s -Wl,-z,relro,-z,now,-z,noexecstack,-Map=$@.map
EXR_CORE     = $(FROM)/libOpenEXRCore.a
LIBS         = $(EXR_CORE) -lz -ldeflate -lnettle -lm
endif

# Debian's name for HDF5 without MPI.
HDF5          = $(shell pkg-config --exists hdf5-serial 2>/dev/null && echo hdf5-serial || \
                    echo hdf5)
# ITK's library names contain its version.
ITK           = $(shell cd /usr/include 2>/dev/null && ls -d ITK-* | tail -n 1)
ITK_IO        = NRRD Meta MINC PNG VTK GIPL HDF5 ImageBase
# UBSan's vptr check tests an object's memory by a pipe, which the confined helper may not create,
# and then reports a wrong type.
VOLUME_FLAGS  = -isystem /usr/include/$(ITK) -isystem $(wildcard /usr/include/gdcm-*) \
                $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(HDF5) 2>/dev/null)) \
                -fno-sanitize=vptr
VOLUME_LIBS   = $(addsuffix $(ITK:ITK%=%),$(ITK_IO:%=-lITKIO%) -lITKMetaIO -lITKCommon -litksys \
                  -litkvnl) \
                -lgdcmMSFF -lgdcmDSED -lgdcmDICT -lgdcmCommon \
                $(shell pkg-config --libs $(HDF5) 2>/dev/null) -ltiff -lexpat -lz

REGISTER_FLAGS = -isystem /usr/include/$(ITK) -fno-sanitize=vptr
REGISTER_LIBS = $(addsuffix $(ITK:ITK%=%),-lITKOptimizersv4 -lITKSmoothing -lITKTransform \
                  -lITKCommon -litkvnl_algo -litkvnl)

# All helpers: confinement.
CONFINED      = $(BUILD)/src/base/confine.o

IMAGE_PARTS   = $(patsubst %.cc,$(BUILD)/%.o,src/helper/iftty-image.cc \
                  $(wildcard src/helper/image_*.cc))
VOLUME_PARTS  = $(patsubst %.cc,$(BUILD)/%.o,src/helper/iftty-volume.cc \
                  $(wildcard src/helper/volume_*.cc))
REGISTER_PARTS = $(patsubst %.cc,$(BUILD)/%.o,$(wildcard src/helper/*register*.cc))

# One line a file, unless V=1; as many files at once as there are cores.
ifeq ($(V),1)
say = @:
Q   =
else
say = @echo
Q   = @
endif
MAKEFLAGS += -j$(shell nproc 2>/dev/null || echo 1)

PARTS   := src/base src/engine src/image src/session src/show src/command src/verify \
           src/apply src/helper src/program journal render tui tui/picture tui/prompt tui/pilot
SOURCES := $(filter-out src/program/manual.c,\
             $(sort $(foreach part,$(PARTS),$(wildcard $(part)/*.c))))
OBJECTS := $(SOURCES:%.c=$(BUILD)/%.o)
LIBRARY := $(BUILD)/libiftty.a
BENCHES := $(patsubst %.c,$(BUILD)/%.o,$(filter-out %/bench.c,$(wildcard tests/bench/*.c)))
BENCH   := $(BUILD)/tests/bench/bench
TESTS   := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/test_*.c))
RACING  := $(patsubst %.c,$(BUILD)/racing/%.o,\
             $(wildcard src/base/*.c src/engine/*.c src/image/*.c render/*.c))

# ThreadSanitizer cannot be combined with other sanitizers.
ifeq ($(SANITISE),)
TESTS += $(BUILD)/tests/test_team_racing $(BUILD)/tests/test_picture_writer_racing \
         $(BUILD)/tests/test_render_team_racing
endif

# Fuzz targets of the readers of outside data, and their corpora. libFuzzer has its own main.
FUZZ          := $(notdir $(wildcard tests/fuzz/corpus/*))
FUZZ_SECONDS  ?= 60
FUZZ_SANITISE := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
FUZZ_TARGETS  := tests/fuzz/targets.c $(wildcard tests/fuzz/fuzz_*.c)
FUZZ_VOLUME   := $(BUILD)/tests/fuzz/fuzz_seg.o \
                 $(patsubst %,$(BUILD)/src/helper/volume_%.o,seg dicom answer series tags bytes \
                   names)
FUZZ_LIBS     := -lgdcmMSFF -lgdcmDSED -lgdcmDICT -lgdcmCommon
FUZZ_TARGETS  := $(FUZZ_TARGETS:%.c=$(BUILD)/%.o)
FUZZ_REPLAY   := $(BUILD)/tests/fuzz/replay
FUZZER        := $(BUILD)/libfuzzer/fuzz

# Programs that iftty is compared with. Debian's Python finds Debian's modules.
PEER_PACKAGES := libinsighttoolkit5-dev libvigraimpex-dev python3-scipy python3-skimage
PEERS_IN_C    := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/peers/*.c))
ITK_JUDGE     := $(BUILD)/tests/peers/itk_compare
PEERS         := $(PEERS_IN_C) $(patsubst %.cc,$(BUILD)/%,$(wildcard tests/peers/*.cc))
PYTHON        := /usr/bin/python3
ROUNDS        ?= 5
ITK_LIBS       = $(addsuffix $(ITK:ITK%=%),-lITKCommon -litkvnl_algo -litkvnl)

# Other compilers and machines, for `make test-matrix`.
MATRIX_PACKAGES := clang libclang-rt-dev gcc-i686-linux-gnu libc6-dev-i386-cross \
                   gcc-aarch64-linux-gnu libc6-dev-arm64-cross gcc-s390x-linux-gnu \
                   libc6-dev-s390x-cross qemu-user-static

# The helpers with a probe in place of their libraries.
PROBES := $(addprefix $(BUILD)/tests/probe/iftty-,image volume register)

# Workflow engines for the scripts of examples/cohort, and their packages; those of bench-apply.
COHORT_PACKAGES := snakemake slurm-wlm iproute2 python3-numpy python3-nibabel python3-scipy \
                   python3-pil
HEAD_PACKAGES   := python3-numpy python3-nibabel python3-scipy

# Terminals, virtual displays, and tools for screenshots and keys.
STAGED            := $(BUILD)/tests/terminals/paint $(BUILD)/tests/terminals/panel
TERMINAL_PACKAGES := xvfb xterm xfonts-base kitty libgl1-mesa-dri mlterm fonts-dejavu-core foot \
                     sway grim wtype xdotool tmux screen pterm rxvt-unicode chafa python3-pil

.DEFAULT_GOAL := all
.PHONY: all install uninstall deb static oci tests test test-long test-stress soak test-bare \
        test-static test-alike test-release lint-deb test-deb test-oci test-reproducible \
        check-format format analyse \
        variants test-matrix test-matrix-short test-terminals test-cohort test-report fuzz fuzzer \
        demo bench-peers bench-chafa bench-brain bench-terminal bench-paper bench-growth \
        bench-render bench-frames bench-journal bench-keys bench-looks bench-effort bench-register \
        bench-series bench-files bench-beside bench-apply bench-surface remake-examples help \
        clean packages
.DELETE_ON_ERROR:
.SECONDARY:

## all: build build/iftty and its three helpers, for images, for volumes and to register scenes (the
##     default); HELPERS=image builds and installs that helper alone
HELPERS ?= image volume register
all: $(BUILD)/iftty $(HELPERS:%=$(BUILD)/iftty-%)

## test: install missing packages, build, run every test; ends with "N passed, N failed,
##     N skipped"; JOBS=2 programs at once (default: cores plus two)
test: all tests build/.packages-test
	@tests/run.sh $(BUILD)

## test-long: ten times the rounds of the property tests of forest, threads, rendition and cuts (a
##     million edits); 500 sessions killed at random moments; the whole mutation test; ten times
##     the files with wrong bytes
test-long: all tests build/.packages-test
	@IFTTY_TEST_SCALE=10 tests/run.sh $(BUILD) test_forest test_render test_cut test_team \
	    test_team_racing test_bands test_render_team test_marker_sessions test_kill test_mutation.sh \
	    test_fuzz.sh test_volumes.sh test_relax

## test-matrix: compare the results of gcc and clang, -O0 to -O3, sanitisers, threads, i386, ARM and
##     s390x
test-matrix: all build/.packages-matrix
	@tests/matrix/run.sh all $(BUILD)

## test-matrix-short: the same for engine, render and journal, and for one example under threads
test-matrix-short: all build/.packages-matrix
	@tests/matrix/run.sh short $(BUILD)

## test-terminals: test pictures, prompt and pilot in real terminals, by screenshot; WORD=kitty
test-terminals: all $(STAGED) build/.packages-terminals
	@$(PYTHON) -B tests/terminals/run.py $(BUILD) $(WORD)

## test-cohort: apply a procedure to twelve subjects by Snakemake and by Slurm, killing tasks; ten
##     minutes
test-cohort: all build/.packages-cohort
	@LIMIT=900 tests/run.sh $(BUILD) cohort.sh

## test-report: draw a page of `iftty report` in a browser, into build/report
test-report: all build/.packages-report
	@tests/run.sh $(BUILD) report.sh

## fuzz: run libFuzzer on the readers; FUZZ_SECONDS=60 each; FUZZ=journal: one of them
fuzz: build/.packages-matrix
	@$(MAKE) VARIANT=fuzz CC=clang CXX=clang++ OPTIMISE=-O1 SANITISE="$(FUZZ_SANITISE)" fuzzer
	@for name in $(FUZZ); do mkdir -p build/fuzz/corpus/$$name && \
	    FUZZ_TARGET=$$name build/fuzz/libfuzzer/fuzz -max_total_time=$(FUZZ_SECONDS) -timeout=20 \
	        -max_len=8192 -rss_limit_mb=4096 -print_final_stats=1 \
	        -artifact_prefix=build/fuzz/$$name- build/fuzz/corpus/$$name \
	        tests/fuzz/corpus/$$name || exit 1; done

## test-stress: run the programs that depend on time 20 times beside 12 busy processes
test-stress: all tests build/.packages-test
	@tests/stress.sh $(BUILD)

## soak: run 100 000 random commands by prompt, pilot and serve, with kills, in ten journals;
##     hours; in build/soak
soak: all build/.packages-test
	@rm -rf build/soak && for seed in 1 2 3 4 5 6 7 8 9 10; do \
	    SEED=$$seed $(PYTHON) -W ignore tests/soak.py build/iftty build/soak/$$seed || exit 1; done

## test-bare: run `make demo`, `make test` and `make deb` in a bare Debian 12 and a bare Debian 13
##     with git, make and gcc; needs root, and some GB in build/bare; SUITES=trixie: one of them
SUITES ?= bookworm trixie
test-bare: build/.packages-bare
	@for suite in $(SUITES); do SUITE=$$suite tests/bare.sh build/bare-$$suite || exit 1; done

## test-reproducible: build HEAD in two folders and compare the bytes of programs, static file and
##     packages; ten minutes
test-reproducible: build/.packages-deb build/.packages-static
	@tests/reproducible.sh

## check-format: check every file against .clang-format.  format: apply .clang-format
check-format: build/.packages-test
	@$(FORMAT) --dry-run -Werror $(FORMATTED)
format: build/.packages-test
	@$(FORMAT) -i $(FORMATTED)

## analyse: run cppcheck, the analyser of gcc and clang-tidy; tests/analyse/exceptions.txt lists
##     accepted findings; eight minutes on two cores
analyse: build/.packages-analyse
	@tests/analyse/run.sh build/analyse

## compile_commands.json: write the compiler's command of each file, for editors and analysers
compile_commands.json: Makefile | $(PACKAGES_STAMP)
	@{ for file in $(filter %.c,$(FORMATTED)); do printf '%s {"directory": "%s", "file": "%s",\n' \
	    "$${comma-[}" "$(CURDIR)" "$$file"; comma=,; printf '  "command": "%s"}\n' \
	    "$(CC) $(ALL_CFLAGS) -c $$file"; done; echo ']'; } >$@

## variants: build and test another variant in its own folder, for example
##     make VARIANT=asan OPTIMISE=-O1 SANITISE="-fsanitize=address,undefined" test
##     make VARIANT=tsan OPTIMISE=-O1 SANITISE=-fsanitize=thread test
##     (stories that a sanitiser cannot run are skipped, by name: tests/may_skip.txt)
##     make VARIANT=debug OPTIMISE="-Og -g3" && gdb --args build/debug/iftty

## tests: build the test programs, and those of bench-peers that need no further package
tests: $(BUILD)/share $(TESTS) $(BENCH) $(FUZZ_REPLAY) $(BUILD)/tests/mutation/nudge \
       $(PEERS_IN_C) $(STAGED) $(ITK_JUDGE) $(PROBES)

## install: build and install the programs, manual, completions and examples below
##     PREFIX=/usr/local, staged in DESTDIR.  uninstall: remove them
install: all $(BUILD)/share
	@.package/install $(BUILD) "$(DESTDIR)" "$(PREFIX)"
uninstall:
	@.package/install -u "$(DESTDIR)" "$(PREFIX)"

## deb: build Debian packages of HEAD in build/deb: iftty, iftty-image, iftty-volume and iftty-doc;
##     fails on an error or a warning of lintian
deb: build/.packages-deb
	@.package/deb build/deb

## lint-deb: lint packages of HEAD with the programs already built; half a minute
lint-deb: all $(BUILD)/share build/.packages-deb
	@.package/deb build/lint-deb $(BUILD)

## test-deb: install and remove these packages by apt in a bare Debian 12; needs root
test-deb: deb build/.packages-bare
	@tests/packages.sh build/deb

## static: build one file that runs on any Linux, build/static/iftty, with its licences and its
##     contents as iftty.spdx.json; ARCH=arm64: build/static-arm64.  test-static: test it
static: $(FROM)/packages
	@$(MAKE) VARIANT=$(STATIC) ARCH=$(ARCH) build/$(STATIC)/iftty
	@.package/sbom build/$(STATIC) $(ARCH)
	@echo "made      build/$(STATIC)/iftty"
test-static: all static build/.packages-test build/.packages-bare
	@tests/static.sh $(BUILD) build/$(STATIC)

## test-alike: check that the program of the checkout, the installed one and the static file write
##     the same journals, verify and continue each other's, and print the same answers
test-alike: all $(BUILD)/share static build/.packages-test
	@tests/release.sh $(BUILD) build/$(STATIC)

## test-release: run the tests of a release that `.ci/run` does not: test-deb, test-static,
##     test-alike, test-bare; some hours
test-release:
	@for target in test-deb test-static test-alike test-bare; do $(MAKE) $$target || exit 1; done
	@echo "test-release passed: packages, static file, bare Debian ($(SUITES))"

## oci: build a container image of the static file, build/oci/iftty-oci.tar, for podman and docker.
##     test-oci: run it by crun; needs root
oci: static build/.packages-oci
	@.package/oci build/$(STATIC) $(ARCH) build/oci
test-oci: all oci build/.packages-test
	@tests/oci.sh $(BUILD) build/oci/iftty-oci.tar

## demo: segment a brain by seeds, render it, replay and verify its journal
demo: $(BUILD)/iftty $(BUILD)/iftty-image
	@examples/demo.sh $(BUILD)

## remake-examples: recompute the pictures and results of examples/ and tests/journals after a
##     change of pictures, if no other word changes; LET=print: allow it in these
remake-examples: all
	@tests/remake.sh $(BUILD) $(LET)

## bench-peers: compare iftty, a textbook DIFT, ITK, vigra, scipy and scikit-image; ROUNDS=5,
##     BITS="8 16", JSON=FILE
bench-peers: $(PEERS)
	@$(PYTHON) tests/peers/run.py --rounds $(ROUNDS) $(BITS:%=--bits %) \
	    $(if $(JSON),--json $(JSON)) $(BUILD)

## bench-brain, bench-terminal, bench-paper, bench-growth, bench-render, bench-frames,
##     bench-journal, bench-keys, bench-looks, bench-effort, bench-register, bench-surface:
##     measure; ARGS=--help lists options
bench-keys bench-register: all
bench-brain bench-terminal bench-paper bench-growth bench-render bench-frames bench-journal \
  bench-keys bench-looks bench-effort bench-register bench-surface: $(BENCH)
	@$(BENCH) $(@:bench-%=%) $(ARGS)

## bench-apply: measure a procedure on other heads; ARGS="--seeds 5 elastic5"
bench-apply: all build/.packages-heads
	@$(PYTHON) -B tests/bench/apply.py $(ARGS) $(BUILD)

## bench-chafa: measure the pictures of `make bench-terminal` by chafa; ARGS=--json
bench-chafa: all build/.packages-chafa
	@$(PYTHON) -B tests/bench/chafa.py $(ARGS) $(BUILD)

## bench-beside: draw the pictures of examples/ beside VTK's, in build/beside; ARGS="--only brain"
bench-beside: all build/.packages-beside
	@$(PYTHON) -B tests/bench/beside.py $(ARGS) $(BUILD)

## bench-series: measure the opening of a DICOM series of 400 slices; ARGS="--slices 100"
bench-series: all build/.packages-test
	@$(PYTHON) -B -W ignore tests/bench/series.py $(ARGS) $(BUILD)

## bench-files: measure the opening of large scenes and the saving of surfaces; ARGS="--rounds 9"
bench-files: all build/.packages-bench-files
	@$(PYTHON) -B tests/bench/files.py $(ARGS) $(BUILD)

## clean: remove the build folder
clean:
	rm -rf build

## help: print this list
help:
	@sed -n 's/^## //p' $(MAKEFILE_LIST)

# Install missing packages once, as root or by sudo; otherwise print the command to type.
PACKAGES_STAMP := build/.packages
packages: $(PACKAGES_STAMP)
$(PACKAGES_STAMP): Makefile
	@mkdir -p build
	@.ci/packages $(PACKAGES) -- $(SCENES) $(INFLATER)
	@touch $@

$(BUILD)/iftty: $(BUILD)/src/main.o $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $< $(LIBRARY) $(LIBS)

# For the static file alone.
$(BUILD)/iftty: $(EXR_CORE)
EXR_PARTS = $(patsubst %.c,%.o,$(wildcard $(FROM)/openexr/OpenEXRCore/*.c))
$(EXR_CORE): $(EXR_PARTS)
	$(Q)$(AR) rcs $@ $^
$(EXR_PARTS): %.o: %.c
	$(Q)$(CC) $(OPTIMISE) $(HARDENED) $(ANYWHERE) -ffp-contract=off $(EXR_CFLAGS) -c -o $@ $<
$(FROM)/packages: .package/libraries | build/.packages-static
	@.package/libraries $(ARCH) $(FROM)

$(IMAGE_PARTS): $(BUILD)/%.o: %.cc | $(PACKAGES_STAMP)
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) -c -o $@ $<

$(BUILD)/iftty-image: $(IMAGE_PARTS) $(CONFINED) $(BUILD)/src/image/linear.o
	$(say) "link      $@"
	$(Q)$(CXX) -o $@ $^ $(ALL_LDFLAGS) $(OIIO_LIBS)

build/.packages-volume: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(VOLUME_PACKAGES) --
	@touch $@

$(VOLUME_PARTS) $(BUILD)/tests/fuzz/fuzz_seg.o: HELPER_FLAGS = $(VOLUME_FLAGS)
$(REGISTER_PARTS): HELPER_FLAGS = $(REGISTER_FLAGS)
$(VOLUME_PARTS) $(REGISTER_PARTS) $(BUILD)/tests/fuzz/fuzz_seg.o: \
    $(BUILD)/%.o: %.cc | build/.packages-volume
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) $(HELPER_FLAGS) -c -o $@ $<

$(BUILD)/iftty-volume: $(VOLUME_PARTS) $(BUILD)/src/helper/csa.o \
                       $(BUILD)/src/image/reader_common.o $(CONFINED)
	$(say) "link      $@"
	$(Q)$(CXX) -o $@ $^ $(ALL_LDFLAGS) $(VOLUME_LIBS)

$(BUILD)/iftty-register: $(REGISTER_PARTS) $(CONFINED) $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CXX) -o $@ $^ $(ALL_LDFLAGS) $(REGISTER_LIBS)

$(BUILD)/tests/probe/%.o: tests/probe/%.cc
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) -c -o $@ $<

$(BUILD)/tests/probe/iftty-register: $(BUILD)/src/helper/iftty-register.o
$(BUILD)/tests/probe/iftty-image $(BUILD)/tests/probe/iftty-volume: \
    $(BUILD)/tests/probe/iftty-%: $(BUILD)/src/helper/iftty-%.o
$(BUILD)/tests/probe/iftty-%: $(BUILD)/tests/probe/probe_%.o $(BUILD)/tests/probe/attempts.o \
                              $(CONFINED)
	$(say) "link      $@"
	$(Q)$(CXX) -o $@ $^ $(ALL_LDFLAGS) $(PROBE_LIBS)
$(BUILD)/tests/probe/iftty-image: PROBE_LIBS = $(OIIO_LIBS)
$(BUILD)/tests/probe/iftty-volume: PROBE_LIBS = $(VOLUME_LIBS)
$(BUILD)/tests/probe/iftty-register: PROBE_LIBS = $(REGISTER_LIBS)

# Manual pages and completions, generated from the tables, in the layout of PREFIX/share.
$(BUILD)/iftty-manual: $(BUILD)/src/program/manual.o $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $< $(LIBRARY) $(LIBS)
$(BUILD)/share: $(BUILD)/iftty-manual
	@rm -rf $@
	@mkdir -p $(addprefix $@/,man/man1 man/man5 bash-completion/completions zsh/site-functions \
	    fish/vendor_completions.d)
	@$< $@

$(LIBRARY): $(OBJECTS)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BENCH) $(BUILD)/tests/test_bench $(BUILD)/tests/test_effort: $(BENCHES)
$(BUILD)/tests/%: $(BUILD)/tests/%.o $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $(filter %.o,$^) $(LIBRARY) $(LIBS)

fuzzer: $(FUZZER)
$(FUZZ_REPLAY): $(BUILD)/tests/fuzz/replay.o $(FUZZ_TARGETS) $(FUZZ_VOLUME) $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CXX) $(ALL_LDFLAGS) -o $@ $^ $(LIBS) $(FUZZ_LIBS)
$(FUZZER): $(FUZZ_TARGETS) $(FUZZ_VOLUME) $(LIBRARY)
	@mkdir -p $(@D)
	$(say) "link      $@"
	$(Q)$(CXX) -fsanitize=fuzzer $(ALL_LDFLAGS) -o $@ $^ $(LIBS) $(FUZZ_LIBS)

build/.packages-test: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(TEST_PACKAGES) -- $(FORMATTER) $(LESSONS) $(HEIC)
	@touch $@

build/.packages-analyse: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(ANALYSERS) --
	@touch $@

build/.packages-chafa: Makefile | $(PACKAGES_STAMP)
	@.ci/packages chafa --
	@touch $@

build/.packages-beside: Makefile | $(PACKAGES_STAMP)
	@.ci/packages python3-vtk9 python3-numpy xvfb python3-pil $(SCENES) --
	@touch $@

build/.packages-cohort: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(COHORT_PACKAGES) $(SCENES) --
	@touch $@

build/.packages-report: Makefile | $(PACKAGES_STAMP)
	@.ci/packages chromium python3-pil --
	@touch $@

build/.packages-heads: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(HEAD_PACKAGES) $(SCENES) --
	@touch $@

build/.packages-bench-files: Makefile | $(PACKAGES_STAMP)
	@.ci/packages libdeflate-tools python3-numpy -- $(SCENES)
	@touch $@

build/.packages-deb: Makefile build/.packages-volume
	@.ci/packages $(DEB_PACKAGES) --
	@touch $@

build/.packages-static: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(STATIC_PACKAGES) --
	@touch $@

build/.packages-oci: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(OCI_PACKAGES) --
	@touch $@

build/.packages-bare: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(BARE_PACKAGES) --
	@touch $@

build/.packages-matrix: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(MATRIX_PACKAGES) -- $(LESSONS)
	@touch $@

build/.packages-terminals: Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(TERMINAL_PACKAGES) --
	@touch $@

# For `make bench-peers`; tests use ITK_JUDGE. The C++ ones are templates and are compiled with the
# options of a release.
PEERS_STAMP  := build/.packages-peers
$(PEERS_STAMP): Makefile | $(PACKAGES_STAMP)
	@.ci/packages $(PEER_PACKAGES) $(SCENES) --
	@touch $@

$(BUILD)/tests/peers/itk_%: PEER_FLAGS = -isystem /usr/include/$(ITK)
$(BUILD)/tests/peers/itk_%: PEER_LIBS = $(ITK_LIBS)
$(ITK_JUDGE): | build/.packages-test
$(filter-out $(PEERS_IN_C) $(ITK_JUDGE),$(PEERS)): | $(PEERS_STAMP)
$(BUILD)/tests/peers/%: tests/peers/%.cc
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) -O3 -DNDEBUG $(PEER_FLAGS) -MF $@.d -o $@ $< $(ALL_LDFLAGS) \
	    $(PEER_LIBS)

$(BUILD)/%.o: %.c | $(PACKAGES_STAMP)
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CC) $(ALL_CFLAGS) -c -o $@ $<

# The stories about threads under ThreadSanitizer.
$(BUILD)/tests/%_racing: $(BUILD)/racing/tests/%.o $(RACING)
	$(say) "link      $@"
	$(Q)$(CC) -fsanitize=thread $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/racing/%.o: %.c | $(PACKAGES_STAMP)
	@mkdir -p $(@D)
	$(say) "compile   $< (for races)"
	$(Q)$(CC) $(ALL_CFLAGS) -fsanitize=thread -c -o $@ $<

-include $(RACING:.o=.d) $(wildcard $(BUILD)/racing/tests/*.d)
-include $(OBJECTS:.o=.d) $(BUILD)/src/main.d $(TESTS:=.d) $(PEERS:=.d) $(IMAGE_PARTS:.o=.d) \
         $(VOLUME_PARTS:.o=.d) $(REGISTER_PARTS:.o=.d) $(STAGED:=.d) $(BENCH).d $(BENCHES:.o=.d) \
         $(BUILD)/src/program/manual.d $(wildcard $(BUILD)/tests/*/*.d)
