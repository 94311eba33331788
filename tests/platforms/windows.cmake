# SPDX-License-Identifier: Apache-2.0
# Windows on x86-64 with MinGW-w64 and POSIX threads; Wine runs the programs. The libraries of the compiler are linked statically,
# so that Wine does not search for them.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)
find_program(PETZVAL_WINE wine)
if(PETZVAL_WINE)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${PETZVAL_WINE})
endif()
