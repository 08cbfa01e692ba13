#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One command does it: installs what is missing (Debian), configures, builds, runs.
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: ./x COMMAND [ARGUMENT...]

  demo [FILE...]   build, then run the main job on the built-in materials, on FILEs, and on what
                   REFLECTREE_DATA holds; results go to reflectree-demo/
  test [--long]    build everything, then run the fast and statistical tests (--long: the long ones too, and
                   the fast ones under sanitizers, and the fuzzers);
                   further arguments go to ctest, such as -R albedo
  build            build everything
  site             build the Python package, then the documentation as pages that need no network, with
                   Sphinx, and with Doxygen for the C++ headers, into build/site; a link that leads nowhere
                   is an error
  bench            build, then run the micro benchmarks; further arguments go to the benchmark
  format           format every C and C++ file in place, but runtime/ and plug-ins in their host's style
  --help           this text

The program is build/bin/reflectree afterwards. Missing Debian packages are installed with apt-get,
through sudo unless root, and the Python packages that tests need with pip into build/venv; a second run
needs neither network nor root. REFLECTREE_JOBS: parallel jobs (default: the number of cores).
REFLECTREE_FUZZ_SECONDS: how long each fuzzer of --long runs (default: 600; all of --long then takes two
hours of two cores).
TEXT
}

die() { echo "x: $1" >&2; exit "${2:-2}"; }

# What each command needs, by Debian name.
build_packages=(g++ cmake ninja-build libtbb-dev libcli11-dev nlohmann-json3-dev libfmt-dev libpng-dev libjpeg-dev libstb-dev zlib1g-dev libboost-dev
                libopenexr-dev libembree-dev libpugixml-dev libtinyobjloader-dev libeigen3-dev)
test_packages=("${build_packages[@]}" libgtest-dev libmpfi-dev python3 python3-numpy python3-venv python3-dev pkgconf
                clang libc++-dev libc++abi-dev)
long_packages=("${test_packages[@]}" libclang-rt-14-dev)
bench_packages=("${build_packages[@]}" libbenchmark-dev)
site_packages=("${test_packages[@]}" doxygen)

installed() { dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null | grep -qx installed; }

need() {
  command -v dpkg-query >/dev/null || return 0  # not Debian: CMake says what is missing
  local missing=() package
  for package in "$@"; do installed "$package" || missing+=("$package"); done
  ((${#missing[@]})) || return 0
  local root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "missing: ${missing[*]}; install them as root with apt-get, or install sudo"
    root=(sudo)
  fi
  echo "x: installing ${missing[*]}" >&2
  "${root[@]}" apt-get -q -o DPkg::Lock::Timeout=600 update >&2
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=600 \
    install --no-install-recommends "${missing[@]}" >&2
}

jobs() { echo "${REFLECTREE_JOBS:-$(nproc)}"; }

# Words go to stderr: stdout belongs to the program that runs in the end.
configure() { (cd "$home" && cmake --preset release "$@" >&2); }
build() { cmake --build "$home/build" --parallel "$(jobs)" --target "$@" >&2; }
# Without tests at first, so that nothing of theirs is needed; after `./x test` they stay.
configure_program() {
  if [[ -f $home/build/CMakeCache.txt ]]; then configure "$@"; else configure -DREFLECTREE_TESTS=OFF -DREFLECTREE_STUDIES=OFF "$@"; fi
}

# The fast tests under AddressSanitizer and UndefinedBehaviorSanitizer, those of the Python binding among them,
# threads that share a sampler under ThreadSanitizer, and every fuzzer for ten minutes.
long_proofs() {
  under() {  # preset, ctest's selection, targets...
    local preset=$1 selection=$2
    shift 2
    cmake --build "$home/build-$preset" --parallel "$(jobs)" --target "$@" >&2
    # shellcheck disable=SC2086
    ctest --test-dir "$home/build-$preset" --output-on-failure --no-tests=error -j "$(jobs)" $selection
  }
  (cd "$home" && cmake --preset asan $(with_python) >&2 && cmake --preset tsan >&2 &&
    cmake --preset fuzz -DREFLECTREE_FUZZ_SECONDS="${REFLECTREE_FUZZ_SECONDS:-600}" >&2)
  under asan '-L ^fast$ -E ^guard' all
  under tsan '-R ^(sampler_build|c.threads)$' test_sampler_build test_c_threads
  under fuzz '-R ^fuzz' fuzzers
}

# Python's packages live in virtual environments beside the build; a second run needs no network.
venv() {
  local folder=$home/build/$1 wanted=$home/$2
  cmp -s "$wanted" "$folder/installed.txt" && return 0
  echo "x: making build/$1 with what $2 names" >&2
  local python=/usr/bin/python3  # the system's, whose headers were installed
  [[ -x $python ]] || python=python3
  "$python" -m venv "$folder" >&2 && "$folder/bin/python" -m pip install --quiet -r "$wanted" >&2 ||
    die "the Python packages of $2 could not be installed into build/$1; is there a network?"
  cp "$wanted" "$folder/installed.txt"
}
venv_of_tests() { venv venv tests/python/requirements.txt; }
with_python() { echo -DREFLECTREE_PYTHON=ON "-DPython_EXECUTABLE=$home/build/venv/bin/python"; }

home=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
command=${1:---help}
(($#)) && shift

case $command in
  demo)
    need "${build_packages[@]}"
    configure_program
    build reflectree
    exec "$home/build/bin/reflectree" demo "$@"
    ;;
  test)
    labels='^(fast|statistical)$'
    if [[ ${1:-} == --long ]]; then
      shift
      need "${long_packages[@]}"
      venv_of_tests
      long_proofs
      labels='^(fast|statistical|long)$'
    fi
    need "${test_packages[@]}"
    venv_of_tests
    configure -DREFLECTREE_TESTS=ON -DREFLECTREE_STUDIES=ON $(with_python)
    build all
    exec ctest --test-dir "$home/build" --output-on-failure --no-tests=error -j "$(jobs)" -L "$labels" "$@"
    ;;
  build)
    need "${test_packages[@]}"
    venv_of_tests
    configure -DREFLECTREE_TESTS=ON -DREFLECTREE_STUDIES=ON $(with_python)
    build all
    ;;
  site)
    need "${site_packages[@]}"
    venv_of_tests
    venv site-venv docs/site/requirements.txt
    configure_program $(with_python)
    build reflectree_python
    python=$home/build/site-venv/bin/python
    rm -rf "$home/build/site"  # a page that is gone must not be found
    (cd "$home" && PYTHONPATH=build/python "$python" -m sphinx -q -W --keep-going -b html -c docs/site . build/site) ||
      die "the site has faults; they stand above" 1
    exec "$python" "$home/tests/guard/site_pages.py" "$home/build/site"
    ;;
  bench)
    need "${bench_packages[@]}"
    configure_program -DREFLECTREE_BENCH=ON
    build bench_micro
    exec "$home/build/bin/bench_micro" "$@"
    ;;
  format)
    need clang-format
    cd "$home"
    # The lines of runtime/ are set by hand and counted; plug-ins are in the style of Mitsuba and pbrt.
    find include src apps bindings tests bench examples \( -name '*.[hc]' -o -name '*.[hc]pp' \) \
      -not -path 'bindings/mitsuba/*' -not -path 'bindings/pbrt/*' -exec clang-format -i {} +
    ;;
  -h | --help | help) usage ;;
  *) die "no command named '$command'; ./x --help lists them" ;;
esac
