# What `cmake --install build/release --prefix P` puts where. Everything is found from the program's own place, so a prefix can be
# moved: the library of the language and the error pages are in the program, the compiler of machine code lies at a fixed way from it.
include(GNUInstallDirs)
set(SYSID_PRIVATE_FOLDER ${CMAKE_INSTALL_LIBDIR}/sysid)  # what nobody else links or loads

# sysid_finds_modules(TARGET FOLDER WAY...): the target, installed in FOLDER, finds the program's modules; and along the other ways, as
# built. One run path for both: CMake ends one that it will replace with a colon, and behind it the dynamic linker reads the folder in
# which the user happens to be.
function(sysid_finds_modules target folder)
  file(RELATIVE_PATH way /prefix/${folder} /prefix/${SYSID_PRIVATE_FOLDER})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/${way};${ARGN}" BUILD_WITH_INSTALL_RPATH ON)
endfunction()
sysid_finds_modules(sysid ${CMAKE_INSTALL_BINDIR} $ORIGIN)

install(TARGETS sysid RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS sysid_records_module LIBRARY DESTINATION ${SYSID_PRIVATE_FOLDER} COMPONENT program)
if(TARGET sysid_native_module)
  install(TARGETS sysid_native_module LIBRARY DESTINATION ${SYSID_PRIVATE_FOLDER} COMPONENT program)
endif()
if(TARGET sysid_mpi_module)
  install(TARGETS sysid_mpi_module LIBRARY DESTINATION ${SYSID_PRIVATE_FOLDER} COMPONENT mpi)
endif()

# Manual pages and completions are made by the program itself, from the tables of its commands, where it runs.
set(made ${CMAKE_BINARY_DIR}/made)
if(NOT CMAKE_CROSSCOMPILING)
  add_custom_command(TARGET sysid POST_BUILD COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:sysid> -DFOLDER=${made}
                                                     -P ${CMAKE_SOURCE_DIR}/cmake/made.cmake)
endif()
install(DIRECTORY ${made}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${made}/completions/sysid DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
# Debian keeps the completions of packages apart from those of zsh itself and of its administrator; elsewhere `site-functions`.
set(SYSID_ZSH_FOLDER ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions CACHE STRING "where completions for zsh are installed")
install(FILES ${made}/completions/_sysid DESTINATION ${SYSID_ZSH_FOLDER} COMPONENT program)
install(FILES ${made}/completions/sysid.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)

# To read: the book with the pages of messages, the modules of the language, and the first case to copy.
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs stdlib DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY models/duffing DESTINATION ${CMAKE_INSTALL_DOCDIR}/models COMPONENT program)
