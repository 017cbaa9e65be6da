# SPDX-License-Identifier: MIT
# iftty: segment 3-D scenes by seeds, in a terminal.  `make help` lists what there is.

CC       ?= cc
CXX      ?= c++
VARIANT  ?= release
OPTIMISE ?= -O2
SANITISE ?=
PREFIX   ?= /usr/local
BUILD    := $(if $(filter release,$(VARIANT)),build,build/$(VARIANT))

PACKAGES := g++ pkg-config libopenimageio-dev libopenexr-dev nettle-dev zlib1g-dev libdeflate-dev \
            openexr openimageio-tools
# Without it, which is for amd64, arm64 and a few more, gzip files are read at a third of the speed.
INFLATER := libisal-dev
# Of iftty-volume and iftty-register alone, which `make demo` does not wait for.
VOLUME_PACKAGES := libinsighttoolkit5-dev libgdcm-dev libhdf5-dev libtiff-dev libexpat1-dev
SCENES   := mricron-data
LESSONS  := invesalius-examples insighttoolkit5-examples
# What tests use; what is after this in a list of packages, is left out where it cannot be had.
TEST_PACKAGES := tmux screen procps python3 python3-nibabel python3-pydicom python3-h5py \
                 python3-jsonschema python3-matplotlib \
                 teem-apps dcmtk medcon plastimatch libinsighttoolkit5-dev python3-tifffile \
                 libtiff-tools openssh-client \
                 bindfs fuse3 python3-pil python3-fonttools fonts-dejavu-extra \
                 man-db groff-base mandoc zsh fish
# Debian 13 has what writes HEIC in a package of its own.
HEIC           = $(shell apt-cache show libheif-plugin-x265 >/dev/null 2>&1 && \
                     echo libheif-plugin-x265)
FORMATTER     := clang-format-14
BARE_PACKAGES := autopkgtest debootstrap
DEB_PACKAGES  := dpkg-dev debhelper lintian
OCI_PACKAGES  := umoci crun
# Of `make static`; for another machine, its compiler and what runs its programs.
CROSS_amd64     := gcc-x86-64-linux-gnu
CROSS_arm64     := gcc-aarch64-linux-gnu
STATIC_PACKAGES  = dpkg-dev $(if $(filter-out $(NATIVE),$(ARCH)),$(CROSS_$(ARCH)) qemu-user-static)
# Other versions of clang-tidy find other things.
ANALYSERS     := cppcheck clang-tidy-14

# Other versions of clang-format put lines otherwise.
FORMAT    = $(firstword $(shell which $(FORMATTER) 2>/dev/null) clang-format)
FORMATTED = $(shell find src journal render tui tests examples -name '*.[ch]' -o -name '*.cc' \
                -o -name '*.hh')

# What makes an error harder to use, in code that reads the files of strangers. Sanitisers do more
# of that, and -O0 has not what _FORTIFY_SOURCE needs.
MACHINE   := $(shell $(CC) -dumpmachine 2>/dev/null)
HARDENED   = $(if $(SANITISE)$(filter -O0,$(OPTIMISE)),,-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3) \
             -fstack-protector-strong -fstack-clash-protection -fPIE \
             $(if $(filter x86_64-%,$(MACHINE)),-fcf-protection)
HARD_LINKS = -pie -Wl,-z,relro,-z,now,-z,noexecstack

# The same bytes wherever the source lies (tests/test_reproducible.sh).
ANYWHERE   = '-ffile-prefix-map=$(CURDIR)=.'

# Warnings are errors where code is tested (.ci/run, `make tests`): other compilers have others.
# Vectors go between static functions alone, so no ABI is at stake where a machine has none.
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

# `make static` for ARCH, of this machine or another: a compiler for it, and Debian's libraries for
# it, below the build, where nothing of the machine is found (.package/libraries).
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

# Debian has HDF5 without MPI beside others, by a name of its own.
HDF5          = $(shell pkg-config --exists hdf5-serial 2>/dev/null && echo hdf5-serial || \
                    echo hdf5)
# ITK's names hold its version.
ITK           = $(shell cd /usr/include 2>/dev/null && ls -d ITK-* | tail -n 1)
ITK_IO        = NRRD Meta MINC PNG VTK GIPL HDF5 ImageBase
# A sanitiser looks whether an object can be read by a pipe, which the helper may not make, and then
# calls its type wrong.
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

# All helpers: how they are confined.
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

# ThreadSanitizer bears no other sanitizer beside it.
ifeq ($(SANITISE),)
TESTS += $(BUILD)/tests/test_team_racing $(BUILD)/tests/test_picture_writer_racing \
         $(BUILD)/tests/test_render_team_racing
endif

# Readers of what comes from outside, and bytes for them. libFuzzer has a main of its own.
FUZZ          := $(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_SECONDS  ?= 60
FUZZ_SANITISE := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
FUZZ_REPLAYS  := $(FUZZ:%=$(BUILD)/tests/fuzz/fuzz_%)
FUZZERS       := $(FUZZ:%=$(BUILD)/libfuzzer/fuzz_%)

# What iftty is measured against. Debian's Python is the one that sees Debian's modules.
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

# Engines for the scripts of examples/cohort, and what those take; and a head for bench-apply.
COHORT_PACKAGES := snakemake slurm-wlm iproute2 python3-numpy python3-nibabel python3-scipy \
                   python3-pil
HEAD_PACKAGES   := python3-numpy python3-nibabel python3-scipy insighttoolkit5-examples

# Terminals, what they are shown on without a screen, and what looks at them and types.
STAGED            := $(BUILD)/tests/terminals/paint $(BUILD)/tests/terminals/panel
TERMINAL_PACKAGES := xvfb xterm xfonts-base kitty libgl1-mesa-dri mlterm fonts-dejavu-core foot \
                     sway grim wtype xdotool tmux screen pterm rxvt-unicode chafa python3-pil

.DEFAULT_GOAL := all
.PHONY: all install uninstall deb static oci tests test test-long test-stress soak test-bare \
        test-static test-alike test-release lint-deb test-deb test-oci test-reproducible \
        check-format format analyse \
        variants test-matrix test-matrix-short test-terminals test-cohort fuzz fuzzers demo \
        bench-peers bench-chafa bench-brain bench-terminal bench-paper bench-growth \
        bench-render bench-frames bench-journal bench-keys bench-looks bench-effort bench-register \
        bench-series bench-files bench-beside bench-apply bench-surface remake-examples help \
        clean packages
.DELETE_ON_ERROR:
.SECONDARY:

## all: build build/iftty and its three helpers, for images, for volumes and to register scenes (the
##     default); HELPERS=image builds and installs that helper alone
HELPERS ?= image volume register
all: $(BUILD)/iftty $(HELPERS:%=$(BUILD)/iftty-%)

## test: install what is missing, build, run every test; ends with "N passed, N failed,
##     N skipped"; JOBS=2 at once, one more than there are cores
test: all tests build/.packages-test
	@tests/run.sh $(BUILD)

## test-long: the property tests of forest, threads, rendition and cuts, ten times over (a million
##     edits); 500 sessions killed at random moments; the mutation test in full; ten times the
##     files with wrong bytes
test-long: all tests build/.packages-test
	@IFTTY_TEST_SCALE=10 tests/run.sh $(BUILD) test_forest test_render test_cut test_team \
	    test_team_racing test_bands test_render_team test_marker_sessions test_kill test_mutation.sh \
	    test_fuzz.sh test_volumes.sh test_relax

## test-matrix: the same bits from gcc and clang, -O0 to -O3, sanitisers, threads, i386, ARM, s390x
test-matrix: all build/.packages-matrix
	@tests/matrix/run.sh all $(BUILD)

## test-matrix-short: the same of engine, render and journal, and of one example under threads
test-matrix-short: all build/.packages-matrix
	@tests/matrix/run.sh short $(BUILD)

## test-terminals: pictures, prompt and pilot in real terminals, by screenshot; WORD=kitty for some
test-terminals: all $(STAGED) build/.packages-terminals
	@$(PYTHON) -B tests/terminals/run.py $(BUILD) $(WORD)

## test-cohort: a procedure for twelve subjects by Snakemake and by Slurm, with tasks that are
##     killed; ten minutes
test-cohort: all build/.packages-cohort
	@LIMIT=900 tests/run.sh $(BUILD) cohort.sh

## fuzz: have libFuzzer look for bytes that break a reader; FUZZ_SECONDS=60 each; FUZZ=journal: one
fuzz: build/.packages-matrix
	@$(MAKE) VARIANT=fuzz CC=clang OPTIMISE=-O1 SANITISE="$(FUZZ_SANITISE)" FUZZ="$(FUZZ)" fuzzers
	@for name in $(FUZZ); do mkdir -p build/fuzz/corpus/$$name && \
	    build/fuzz/libfuzzer/fuzz_$$name -max_total_time=$(FUZZ_SECONDS) -timeout=20 -max_len=8192 \
	        -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix=build/fuzz/$$name- \
	        build/fuzz/corpus/$$name tests/fuzz/corpus/$$name || exit 1; done

## test-stress: the programs that depend on time, 20 times under a load of 12 busy processes
test-stress: all tests build/.packages-test
	@tests/stress.sh $(BUILD)

## soak: 100 000 random commands by prompt, pilot and serve, with kills; some hours, in build/soak
soak: build/iftty
	@rm -rf build/soak && python3 tests/soak.py build/iftty build/soak

## test-bare: `make demo` and `make test` in a bare Debian 12 and in a bare Debian 13 with git, make
##     and gcc alone; asks for root, and some GB in build/bare; SUITES=trixie: in that one
SUITES ?= bookworm trixie
test-bare: build/.packages-bare
	@for suite in $(SUITES); do SUITE=$$suite tests/bare.sh build/bare-$$suite || exit 1; done

## test-reproducible: what is committed, built in two folders, comes out as the same bytes:
##     programs, the static file, packages; ten minutes
test-reproducible: build/.packages-deb build/.packages-static
	@tests/reproducible.sh

## check-format: is every file as .clang-format has it?  format: make it so
check-format: build/.packages-test
	@$(FORMAT) --dry-run -Werror $(FORMATTED)
format: build/.packages-test
	@$(FORMAT) -i $(FORMATTED)

## analyse: what cppcheck, the analyser of gcc and clang-tidy find, without what is explained
##     (tests/analyse/exceptions.txt); eight minutes on two cores
analyse: build/.packages-analyse
	@tests/analyse/run.sh build/analyse

## compile_commands.json: how every file is compiled, for editors and analysers
compile_commands.json: Makefile | $(PACKAGES_STAMP)
	@{ for file in $(filter %.c,$(FORMATTED)); do printf '%s {"directory": "%s", "file": "%s",\n' \
	    "$${comma-[}" "$(CURDIR)" "$$file"; comma=,; printf '  "command": "%s"}\n' \
	    "$(CC) $(ALL_CFLAGS) -c $$file"; done; echo ']'; } >$@

## variants: build and test in a folder of their own, such as
##     make VARIANT=asan OPTIMISE=-O1 SANITISE="-fsanitize=address,undefined" test
##     make VARIANT=tsan OPTIMISE=-O1 SANITISE=-fsanitize=thread test
##     (what a sanitiser cannot do is skipped, and named: tests/may_skip.txt)
##     make VARIANT=debug OPTIMISE="-Og -g3" && gdb --args build/debug/iftty

## tests: build the test programs, and those of bench-peers that need no other package
tests: $(BUILD)/share $(TESTS) $(BENCH) $(FUZZ_REPLAYS) $(BUILD)/tests/mutation/nudge \
       $(PEERS_IN_C) $(STAGED) $(ITK_JUDGE) $(PROBES)

## install: build all, and install it with its manual, completions and examples, below
##     PREFIX=/usr/local, staged in DESTDIR.  uninstall: takes all of it away
install: all $(BUILD)/share
	@.package/install $(BUILD) "$(DESTDIR)" "$(PREFIX)"
uninstall:
	@.package/install -u "$(DESTDIR)" "$(PREFIX)"

## deb: Debian packages of what is committed, in build/deb: iftty, iftty-image, iftty-volume and
##     iftty-doc; fails where lintian has an error or a warning
deb: build/.packages-deb
	@.package/deb build/deb

## lint-deb: lint packages of what is committed, with the programs that are built; half a minute
lint-deb: all $(BUILD)/share build/.packages-deb
	@.package/deb build/lint-deb $(BUILD)

## test-deb: these packages in a bare Debian 12, whose apt installs and removes them; asks for root
test-deb: deb build/.packages-bare
	@tests/packages.sh build/deb

## static: one file that runs on any Linux, build/static/iftty, with its licences, and what is in it
##     as iftty.spdx.json; ARCH=arm64: build/static-arm64.  test-static: where nothing else is
static: $(FROM)/packages
	@$(MAKE) VARIANT=$(STATIC) ARCH=$(ARCH) build/$(STATIC)/iftty
	@.package/sbom build/$(STATIC) $(ARCH)
	@echo "made      build/$(STATIC)/iftty"
test-static: all static build/.packages-test build/.packages-bare
	@tests/static.sh $(BUILD) build/$(STATIC)

## test-alike: the checkout's program, the installed one and the static file make the same
##     journals, verify and continue each other's, and answer alike
test-alike: all $(BUILD)/share static build/.packages-test
	@tests/release.sh $(BUILD) build/$(STATIC)

## test-release: what a release needs besides `.ci/run`, one after the other: test-deb, test-static,
##     test-alike, test-bare; some hours
test-release:
	@for target in test-deb test-static test-alike test-bare; do $(MAKE) $$target || exit 1; done
	@echo "test-release passed: packages, static file, bare Debian ($(SUITES))"

## oci: the static file as a container image, build/oci/iftty-oci.tar, which podman and docker load.
##     test-oci: it runs there, by crun; asks for root
oci: static build/.packages-oci
	@.package/oci build/$(STATIC) $(ARCH) build/oci
test-oci: all oci build/.packages-test
	@tests/oci.sh $(BUILD) build/oci/iftty-oci.tar

## demo: segment a brain by seeds, render it, replay and verify the journal
demo: $(BUILD)/iftty $(BUILD)/iftty-image
	@examples/demo.sh $(BUILD)

## remake-examples: after a change of pictures, examples/ and the journal of the present semantics
##     in tests/journals anew, with their locks, if every other word stays; LET=print: but in those
remake-examples: all
	@tests/remake.sh $(BUILD) $(LET)

## bench-peers: the same work by iftty, ITK, vigra, scipy and scikit-image; ROUNDS=5, JSON=FILE
bench-peers: $(PEERS)
	@$(PYTHON) tests/peers/run.py --rounds $(ROUNDS) $(if $(JSON),--json $(JSON)) $(BUILD)

## bench-brain, bench-terminal, bench-paper, bench-growth, bench-render, bench-frames,
##     bench-journal, bench-keys, bench-looks, bench-effort, bench-register, bench-surface:
##     ARGS=--help says which options
bench-keys bench-register: all
bench-brain bench-terminal bench-paper bench-growth bench-render bench-frames bench-journal \
  bench-keys bench-looks bench-effort bench-register bench-surface: $(BENCH)
	@$(BENCH) $(@:bench-%=%) $(ARGS)

## bench-apply: a procedure carried to other heads; ARGS="--seeds 5 elastic5"
bench-apply: all build/.packages-heads
	@$(PYTHON) -B tests/bench/apply.py $(ARGS) $(BUILD)

## bench-chafa: the pictures of `make bench-terminal` by chafa; ARGS=--json
bench-chafa: all build/.packages-chafa
	@$(PYTHON) -B tests/bench/chafa.py $(ARGS) $(BUILD)

## bench-beside: the pictures of examples/ beside VTK's, in build/beside, and how far both are from
##     the truth of shapes that are known; ARGS="--only brain", ARGS="--only truth"
bench-beside: all build/.packages-beside
	@$(PYTHON) -B tests/bench/beside.py $(ARGS) $(BUILD)

## bench-series: how long a DICOM series of 400 slices takes to open; ARGS="--slices 100"
bench-series: all build/.packages-test
	@$(PYTHON) -B -W ignore tests/bench/series.py $(ARGS) $(BUILD)

## bench-files: how long a large scene takes to open, and a surface to be saved; ARGS="--rounds 9"
bench-files: all build/.packages-bench-files
	@$(PYTHON) -B tests/bench/files.py $(ARGS) $(BUILD)

## clean: remove the build folder
clean:
	rm -rf build

## help: this list
help:
	@sed -n 's/^## //p' $(MAKEFILE_LIST)

# What is missing is installed once, by whoever may; otherwise the command to type is printed.
PACKAGES_STAMP := build/.packages
packages: $(PACKAGES_STAMP)
$(PACKAGES_STAMP): Makefile
	@mkdir -p build
	@.ci/packages $(PACKAGES) -- $(SCENES) $(INFLATER)
	@touch $@

$(BUILD)/iftty: $(BUILD)/src/main.o $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $< $(LIBRARY) $(LIBS)

# Of the static file alone.
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

$(VOLUME_PARTS): HELPER_FLAGS = $(VOLUME_FLAGS)
$(REGISTER_PARTS): HELPER_FLAGS = $(REGISTER_FLAGS)
$(VOLUME_PARTS) $(REGISTER_PARTS): $(BUILD)/%.o: %.cc | build/.packages-volume
	@mkdir -p $(@D)
	$(say) "compile   $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) $(HELPER_FLAGS) -c -o $@ $<

$(BUILD)/iftty-volume: $(VOLUME_PARTS) $(BUILD)/src/helper/csa.o $(BUILD)/src/image/inflated.o \
                       $(BUILD)/src/image/units.o $(BUILD)/src/base/choice.o $(CONFINED)
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

# Pages of the manual and completions, generated from the tables, as they are below PREFIX/share.
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

fuzzers: $(FUZZERS)
$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(BUILD)/tests/fuzz/replay.o \
                            $(BUILD)/tests/fuzz/file.o $(LIBRARY)
	$(say) "link      $@"
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)
$(BUILD)/libfuzzer/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(BUILD)/tests/fuzz/file.o $(LIBRARY)
	@mkdir -p $(@D)
	$(say) "link      $@"
	$(Q)$(CC) -fsanitize=fuzzer $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

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

# `make bench-peers` needs these, and tests that of ITK_JUDGE. The C++ ones are templates, and get
# the options of a release.
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

# The threads' stories once more, under ThreadSanitizer.
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
