# WebAssembly with 128-bit vectors by Debian's emscripten, programs run by Node: bash cmake/browser.sh. Who builds has
# NODE_PATH=/usr/share/nodejs in the environment.
set(EMSCRIPTEN_SYSTEM_PROCESSOR wasm32)
set(RDM_CROSS_TARGET wasm)
set(RDM_CROSS_SYSTEM /usr/share/emscripten/cache/sysroot)
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/found.cmake)
set(CMAKE_CROSSCOMPILING_EMULATOR node --no-experimental-fetch)
# LLVM 14 makes wrong vectors of whole numbers that become doubles (two draws of Stream::uniform side by side), so vectors
# are those that are written as such. These are its own options, since -fno-slp-vectorize counts behind -O3 alone.
set(flags "-msimd128 -mllvm -vectorize-slp=false -mllvm -vectorize-loops=false")
set(CMAKE_C_FLAGS_INIT "${flags}")
set(CMAKE_CXX_FLAGS_INIT "${flags} -fwasm-exceptions")
# programs: worlds of any size, files of this machine, the stack of a thread elsewhere
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-fwasm-exceptions -sALLOW_MEMORY_GROWTH=1 -sNODERAWFS=1 -sTOTAL_STACK=1048576 -sEXIT_RUNTIME=1 -lstdc++")
set(gtest_disable_pthreads ON CACHE BOOL "One thread")
set(LIBM_LIBRARY m CACHE STRING "In the C library")
