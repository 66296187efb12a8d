# Toolchain for AArch64 on a Debian machine of another processor. SYSID_SYSROOT names a folder with the libraries for AArch64, as
# tests/processors/run unpacks them; programs run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SYSID_SYSROOT)

set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CXX_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH ${SYSID_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# The C library is that of the compiler: headers of the folder come after its own.
set(folders ${SYSID_SYSROOT}/usr/lib/aarch64-linux-gnu ${SYSID_SYSROOT}/lib/aarch64-linux-gnu)
# GCC notes in headers of Boost how arguments were passed before its version 10.
set(CMAKE_CXX_FLAGS_INIT "-Wno-psabi -idirafter ${SYSID_SYSROOT}/usr/include -idirafter ${SYSID_SYSROOT}/usr/include/aarch64-linux-gnu")
foreach(folder IN LISTS folders)
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -Wl,-rpath-link,${folder}")
endforeach()
set(CMAKE_SHARED_LINKER_FLAGS_INIT ${CMAKE_EXE_LINKER_FLAGS_INIT})
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${SYSID_SYSROOT})
