# 64-bit ARM with Linux by Debian's cross compiler, programs run by qemu: bash cmake/check.sh arm64.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L /usr/aarch64-linux-gnu)
set(RDM_CROSS_TARGET arm64)
set(RDM_CROSS_SYSTEM /usr/aarch64-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/found.cmake)
