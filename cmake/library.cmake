# libsysid: the density of a fit for programs of C and C++. It exports the names of sysid.h and nothing else, so it can be linked with
# any compiler, and with other versions of what is in it.
set(SYSID_ABI 0)  # raised when a program that was linked with an earlier version would no longer work
sysid_fast_objects(fast_objects sysid_embed)
add_library(sysid_shared SHARED ${fast_objects} src/library/library.cpp)
add_library(sysid::sysid ALIAS sysid_shared)
set_target_properties(sysid_shared PROPERTIES OUTPUT_NAME sysid EXPORT_NAME sysid VERSION ${PROJECT_VERSION} SOVERSION ${SYSID_ABI}
                                              CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON UNITY_BUILD OFF
                                              LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}
                                              LINK_DEPENDS ${CMAKE_SOURCE_DIR}/src/library/exports.map)
target_link_libraries(sysid_shared PRIVATE sysid_embed)
target_link_options(sysid_shared PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections -Wl,-Bsymbolic
                                         -Wl,--version-script=${CMAKE_SOURCE_DIR}/src/library/exports.map)
target_include_directories(sysid_shared INTERFACE $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src/library>
                                                  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
sysid_compile_lightly(sysid_shared)
sysid_finds_modules(sysid_shared ${CMAKE_INSTALL_LIBDIR} $ORIGIN)

# For `find_package(sysid)` and for pkg-config. Neither names the prefix.
include(CMakePackageConfigHelpers)
set(SYSID_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/sysid)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/sysidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH SYSID_PREFIX_FROM_PC /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_SOURCE_DIR}/cmake/sysid.pc.in ${CMAKE_BINARY_DIR}/generated/sysid.pc @ONLY)
install(TARGETS sysid_shared EXPORT sysid LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(FILES src/library/sysid.h src/library/sysid.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT sysid FILE sysidConfig.cmake NAMESPACE sysid:: DESTINATION ${SYSID_CMAKE_FOLDER} COMPONENT library)
install(FILES ${CMAKE_BINARY_DIR}/generated/sysidConfigVersion.cmake DESTINATION ${SYSID_CMAKE_FOLDER} COMPONENT library)
install(FILES ${CMAKE_BINARY_DIR}/generated/sysid.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
