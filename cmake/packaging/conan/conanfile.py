"""Conan 2 recipe of the tree that it stands in: conan create cmake/packaging/conan. A profile's [platform_requires] takes
ode, libccd, octomap and eigen from the system instead of building them."""
from pathlib import Path

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir
from conan.tools.gnu import PkgConfigDeps
import re

required_conan_version = ">=2.9"


class Redman(ConanFile):
    name = "redman"
    description = "Safe dexterous manipulation: worlds, safe reinforcement learning, frozen policies; a C99 interface"
    license = "Apache-2.0"
    topics = ("robotics", "reinforcement-learning", "simulation")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "sim": [True, False], "learn": [True, False]}
    default_options = {"shared": True, "sim": True, "learn": True,
                       "ode/*:precision": "double", "libccd/*:enable_double_precision": True}

    @property
    def _tree(self):
        return Path(self.recipe_folder).resolve().parents[2]

    def set_version(self):
        header = load(self, self._tree / "include/redman/base.h")
        self.version = ".".join(re.search(rf"#define RDM_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))

    def export_sources(self):
        for part in ("cmake", "include", "lib", "tasks", "algos", "capi", "examples"):
            copy(self, f"{part}/*", self._tree, self.export_sources_folder, excludes=["*.pyc", "examples/pictures/*"])
        for part in ("CMakeLists.txt", "LICENSE", "README.md"):
            copy(self, part, self._tree, self.export_sources_folder)

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os != "Linux" or self.settings.arch != "x86_64":
            raise ConanInvalidConfiguration("redman is for Linux on x86-64")

    def requirements(self):
        self.requires("eigen/[>=3.4 <3.5]")
        if self.options.sim:
            self.requires("ode/[>=0.16]")
            self.requires("libccd/[>=2.1]")
            self.requires("octomap/[>=1.9]")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({
            "REDMAN_SIM": bool(self.options.sim), "REDMAN_LEARN": bool(self.options.learn), "REDMAN_POLICY": True,
            "REDMAN_SHARED": bool(self.options.shared), "REDMAN_TESTS": False, "REDMAN_EXAMPLES": False,
            "REDMAN_IMPORT": "OFF"})
        toolchain.generate()
        CMakeDeps(self).generate()
        pkg_config = PkgConfigDeps(self)
        pkg_config.set_property("ode", "pkg_config_custom_content", "precision=dDOUBLE")  # which the build asks for
        pkg_config.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder) / "licenses")
        rmdir(self, Path(self.package_folder) / "lib/cmake")  # conan writes its own
        rmdir(self, Path(self.package_folder) / "lib/pkgconfig")
        rmdir(self, Path(self.package_folder) / "share")

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "redman")
        self.cpp_info.set_property("cmake_target_name", "redman::redman")
        self.cpp_info.set_property("pkg_config_name", "redman")
        self.cpp_info.libs = ["redman"]
        if not self.options.shared:
            self.cpp_info.system_libs = ["stdc++", "m", "pthread"]
