#!/usr/bin/env python3
"""same_bytes.py: builds what simulates and plans with each compiler, optimisation and processor that this machine has, and compares the states that
twenty scenes, a heap and a packing session come to (tests/same_bytes/states.cpp). Exit code 1 where they differ.

Variants: gcc-O3, gcc-O1, clang-O3, clang-O1, and the same with aarch64- before. On x86-64 each runs with the instructions of the processor, and with
AVX2 and fused multiply-add left out by the C library. aarch64 needs g++ for it and qemu (Debian: g++-aarch64-linux-gnu qemu-user-static); what it
links is fetched by apt into a folder of its own, nothing is installed. What this machine cannot build is named, and is no success of --all."""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WITHOUT = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}
ARM = "aarch64-linux-gnu"
VARIANTS = tuple(f"{processor}{compiler}-{level}" for processor in ("", "aarch64-") for compiler in ("gcc", "clang") for level in ("O3", "O1"))
EMULATOR = "qemu-aarch64-static"
ARM_PACKAGES = ("libc6-dev libstdc++-12-dev libeigen3-dev libexpected-dev libceres-dev libblas-dev liblapack-dev libnlopt-cxx-dev libhdf5-dev "
                "libyaml-cpp-dev libfmt-dev nlohmann-json3-dev libtinyxml2-dev libassimp-dev libpng-dev zlib1g-dev").split()
TOOLCHAIN = """set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_SYSROOT {root})
set(CMAKE_C_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH {root})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(HDF5_C_LIBRARY_hdf5 {root}/usr/lib/aarch64-linux-gnu/hdf5/serial/libhdf5.so CACHE FILEPATH "")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,{root}/usr/lib/aarch64-linux-gnu{more}")
set(ENV{{PKG_CONFIG_SYSROOT_DIR}} {root})
set(ENV{{PKG_CONFIG_LIBDIR}} {root}/usr/lib/aarch64-linux-gnu/pkgconfig:{root}/usr/share/pkgconfig)
"""


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise SystemExit(f"same_bytes.py: {' '.join(str(word) for word in words)}:\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def make_sysroot(folder):
    """A folder with the packages of another processor: by lists of apt's own, beside those of the system."""
    root = folder / "sysroot"
    if (root / "complete").exists():
        return root
    apt = folder / "apt"
    for part in ("lists/partial", "cache/archives/partial", "state"):
        (apt / part).mkdir(parents=True, exist_ok=True)
    (apt / "state" / "status").touch()
    (apt / "apt.conf").write_text(f'APT::Architecture "arm64";\nAPT::Architectures {{ "arm64"; }};\nDir::State "{apt}/state";\n'
                                  f'Dir::State::lists "{apt}/lists";\nDir::State::status "{apt}/state/status";\nDir::Cache "{apt}/cache";\n'
                                  'APT::Sandbox::User "root";\n')
    environment = {**os.environ, "APT_CONFIG": str(apt / "apt.conf")}
    run("apt-get", "update", "-qq", env=environment)
    run("apt-get", "install", "-y", "-qq", "--download-only", "--no-install-recommends", *ARM_PACKAGES, env=environment)
    for package in sorted((apt / "cache" / "archives").glob("*.deb")):
        run("dpkg", "-x", package, root)
    libraries = root / "usr/lib/aarch64-linux-gnu"
    for name in ("blas", "lapack"):  # alternatives, which nobody has chosen here
        for file in (libraries / name).glob(f"lib{name}.*"):
            if not (target := libraries / file.name).exists():
                target.symlink_to(Path(name) / file.name)
    for link in libraries.iterdir():
        if link.is_symlink() and (target := os.readlink(link)).startswith("/"):
            link.unlink()
            link.symlink_to(root / target.lstrip("/"))
    for file in (libraries / "cmake").rglob("*.cmake"):  # some name libraries by whole paths
        file.write_text(re.sub(r'(?<=["; :])/usr(?=[/";])', f"{root}/usr", file.read_text()))
    (root / "complete").touch()
    return root


def find_compiler(name):
    found = shutil.which(name) or shutil.which(name + "-12")
    return Path(found) if found else None


def compilers(variant):
    """The programs that compile C and C++, and the level of optimisation."""
    compiler, level = variant.removeprefix("aarch64-").split("-")
    names = ("gcc", "g++") if compiler == "gcc" else ("clang", "clang++")
    if variant.startswith("aarch64") and compiler == "gcc":
        names = tuple(f"{ARM}-{name}" for name in names)
    return *names, "-" + level


def what_is_missing(variant):
    c, cxx, _ = compilers(variant)
    more = [f"{ARM}-g++", EMULATOR, "apt-get", "dpkg"] if variant.startswith("aarch64") else []  # clang links with the linker of g++
    return [name for name in dict.fromkeys([c, cxx, *more]) if find_compiler(name) is None]


def build(variant, folder, jobs):
    """The program of a variant, and the words before it."""
    c, cxx, optimisation = compilers(variant)
    build_folder = folder / variant
    build_folder.mkdir(parents=True, exist_ok=True)
    before = []
    more = []
    if variant.startswith("aarch64"):
        root = make_sysroot(folder / "aarch64")
        libraries = find_compiler(f"{ARM}-g++").resolve().parent.parent / ARM / "lib"
        toolchain = folder / "aarch64" / "toolchain.cmake"
        toolchain.write_text(TOOLCHAIN.format(root=root, more=f",-rpath-link,{libraries}"))
        more = [f"-DCMAKE_TOOLCHAIN_FILE={toolchain}"]
        before = [find_compiler(EMULATOR), "-L", root]
    run("cmake", "-S", ROOT, "-B", build_folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_C_COMPILER={find_compiler(c)}",
        f"-DCMAKE_CXX_COMPILER={find_compiler(cxx)}", f"-DCMAKE_CXX_FLAGS_RELEASE={optimisation} -DNDEBUG",
        f"-DCMAKE_C_FLAGS_RELEASE={optimisation} -DNDEBUG", "-DSNUG_MODULES=session;simulated_plant", "-DSNUG_PROGRAM=OFF", "-DSNUG_TESTS=OFF",
        "-DSNUG_INSTALL=OFF", "-DSNUG_PYTHON_MODULE=OFF", *more)
    run("cmake", "--build", build_folder, "-j", jobs, "--target", "snug_states")
    return [*before, build_folder / "tests" / "same_bytes" / "snug_states"]


def states(words, more):
    return json.loads(run(*words, ROOT / "scenarios", env={**os.environ, **more}))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help="of " + " ".join(VARIANTS) + "; all that this machine can build if none is named")
    parser.add_argument("--folder", type=Path, default=ROOT / "build-same", help="where it is built (default: build-same)")
    parser.add_argument("--jobs", default=str(os.cpu_count() or 1))
    parser.add_argument("--all", action="store_true", help="a variant that cannot be built here is a failure")
    words = parser.parse_args()
    if unknown := [name for name in words.variants if name not in VARIANTS]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(VARIANTS)}")
    found, is_missing = {}, False
    for variant in words.variants or VARIANTS:
        if missing := what_is_missing(variant):
            print(f"{variant}: not built, there is no {', no '.join(missing)}", flush=True)
            is_missing = True
            continue
        program = build(variant, words.folder.resolve(), words.jobs)
        for name, more in ((variant, {}), (variant + " without AVX2, FMA", WITHOUT)):
            if more and variant.startswith("aarch64"):
                continue
            found[name] = states(program, more)
            print(f"{name}: {len(found[name])} states", flush=True)
    first = next(iter(found), None)
    different = [(scene, name) for name in found for scene in found[name] if found[name][scene] != found[first].get(scene)]
    for scene, name in different:
        print(f"differs: {scene}: {found[first].get(scene)} by {first}, {found[name][scene]} by {name}")
    count = len(found[first]) if first else 0
    print(f"{count - len({scene for scene, _ in different})} of {count} states are the same in {len(found)} variants")
    sys.exit(1 if different or not found or (is_missing and (words.all or words.variants)) else 0)


if __name__ == "__main__":
    main()
