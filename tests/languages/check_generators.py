#!/usr/bin/env python3
"""Each public header, alone, through the generators of bindings: bindgen, cffi, SWIG and cgo.

Arguments: the project's root, a folder for what is written, the libraries. Prints a row a header: how many functions and
structs each generator made of it. Ends with 1 where one stumbles, leaves out what the header declares, or gives a struct
another size than C does (SWIG's wrappers are C, and say none); with 77 where a tool is missing.
"""
import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import sys


class Header:
    """The functions and structs that a header declares itself."""

    def __init__(self, path):
        self.path = path
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
        self.functions = set(re.findall(r"^RDM_API [^;(]*?\b(rdm_\w+)\(", re.sub(r"RDM_DEPRECATED\(.*?\)", "", text), re.M))
        self.structs = re.findall(r"^typedef struct (rdm_\w+) \{", text, re.M)


class Generators:
    """Each method returns the functions and the structs that were made."""

    def __init__(self, root, work, libraries):
        self.include, self.work, self.libraries = root / "include", work, libraries
        golden = [line.split() for line in (root / "capi/layout.golden").read_text().splitlines()]
        self.sizes = {words[0]: int(words[1]) for words in golden if len(words) == 2}

    def run(self, *command, **more):
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
        if done.returncode:
            raise RuntimeError((done.stderr or done.stdout).strip())
        return done.stdout

    def same_sizes(self, made):
        for struct, size in made.items():
            if size != self.sizes[struct]:
                raise RuntimeError(f"{struct} has {size} bytes, in C {self.sizes[struct]}")
        return set(made)

    def bindgen(self, header):
        written = self.work / "bindgen.rs"
        self.run("bindgen", header.path, "--size_t-is-usize", "--allowlist-file", ".*/redman/[a-z_]+\\.h", "-o", written,
                 "--", f"-I{self.include}", "-DRDM_NO_DEPRECATED")
        text = written.read_text()
        sizes = re.findall(r"size_of::<(rdm_\w+)>\(\),\s*(\d+)usize", text)
        return set(re.findall(r"pub fn (rdm_\w+)", text)), self.same_sizes({name: int(size) for name, size in sizes})

    def cffi(self, header):
        import cffi
        lines, ours = [], False
        for line in self.run("cc", "-E", "-std=c99", f"-I{self.include}", "-D__attribute__(x)=", "-DRDM_NO_DEPRECATED",
                             header.path).splitlines():
            marker = re.match(r'# \d+ "([^"]*)"', line)
            if marker:  # what follows is of this file
                ours = "/redman/" in marker[1]
            elif ours:
                lines.append(line)
        ffi = cffi.FFI()
        ffi.cdef("\n".join(lines))
        opened = [ffi.dlopen(str(library)) for library in self.libraries]
        return ({name for name in header.functions if any(hasattr(library, name) for library in opened)},
                self.same_sizes({struct: ffi.sizeof(struct) for struct in header.structs}))

    def swig(self, header):
        written = self.work / "swig.c"  # of what other headers define it is told, for it does not go into them
        self.run("swig", "-python", "-Werror", "-w451", "-DRDM_API=", "-DRDM_DEPRECATED(x)=", "-DRDM_NO_DEPRECATED",
                 *([] if header.path.name == "agent.h" else ["-DREDMAN_AGENT_H"]), f"-I{self.include}", "-module", "redman",
                 "-outdir", self.work, "-o", written, header.path)
        text = written.read_text()
        return set(re.findall(r"_wrap_(rdm_\w+)\(", text)), set(re.findall(r"_wrap_new_(rdm_\w+)\(", text))

    def cgo(self, header):
        folder = self.work / "cgo"
        folder.mkdir(exist_ok=True)
        used = [f"var _ = unsafe.Pointer(C.{name})" for name in sorted(header.functions)]
        used += [f"var _ [{self.sizes[struct]}]byte = [unsafe.Sizeof(C.{struct}{{}})]byte{{}}" for struct in header.structs]
        (folder / "main.go").write_text("\n".join([
            "package main", f"// #include <redman/{header.path.name}>", 'import "C"', 'import "unsafe"', *used,
            "var _ = unsafe.Sizeof(0)", "func main() {}", ""]))
        (folder / "go.mod").write_text("module generators\n\ngo 1.19\n")
        self.run("go", "vet", ".", cwd=folder, env={
            "GOCACHE": str(self.work / "cache"), "GOFLAGS": "-mod=mod", **os.environ,
            "CGO_CFLAGS": f"-I{self.include} -DRDM_NO_DEPRECATED"})
        return header.functions, set(header.structs)


def main(root, work, *libraries):
    root, work = pathlib.Path(root).resolve(), pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    missing = [tool for tool in ("bindgen", "swig", "go", "cc") if not shutil.which(tool)]
    try:
        import cffi  # noqa: F401
    except ImportError:
        missing.append("cffi")
    if missing:
        print(f"missing: {' '.join(missing)}")
        return 77
    for library in libraries:  # that of the importers needs the other
        ctypes.CDLL(library, ctypes.RTLD_GLOBAL)
    generators = Generators(root, work, libraries)
    names = ("bindgen", "cffi", "swig", "cgo")
    print(f"{'functions/structs':18} declared " + " ".join(f"{name:>8}" for name in names))
    status = 0
    for path in sorted((generators.include / "redman").glob("*.h")):
        header, cells, wrong = Header(path), [], []
        for name in names:
            try:
                functions, structs = getattr(generators, name)(header)
                cells.append(f"{len(functions & header.functions)}/{len(structs & set(header.structs))}")
                wrong += [f"{name}: not {lost}" for lost in sorted({*header.functions, *header.structs} - functions - structs)]
            except Exception as error:  # of any generator, to be shown
                cells.append("no")
                wrong.append(f"{name}: {error}")
        declared = f"{len(header.functions)}/{len(header.structs)}"
        print(f"{path.name:18} {declared:>8} " + " ".join(f"{cell:>8}" for cell in cells))
        for line in wrong:
            print(f"  {line}")
        status |= bool(wrong)
    return status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
