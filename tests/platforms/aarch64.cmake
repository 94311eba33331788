# SPDX-License-Identifier: Apache-2.0
# Linux on 64-bit ARM with Debian's cross compiler; qemu-user runs the programs.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
find_program(PETZVAL_QEMU qemu-aarch64)
if(PETZVAL_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${PETZVAL_QEMU} -L /usr/aarch64-linux-gnu)
endif()
