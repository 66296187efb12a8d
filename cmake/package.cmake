# Debian packages by CPack: `sysid` with the program, `python3-sysid` with the module, in one command
# (`cmake --workflow --preset package`, docs/install.md).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sysid)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR sysid)
set(CPACK_PACKAGE_CONTACT "The sysid authors <sysid@users.noreply.github.com>" CACHE STRING "maintainer named in packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program)
if(TARGET sysid_mpi_module)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(TARGET sysid_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME sysid)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox, libopenblas0-pthread")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Bayesian identification of nonlinear systems
A language for equations with unknown parameters, and the program that
estimates them from measured data: posteriors, predictions with their
uncertainty, comparison of models, discovery of equations, and checks
of every result.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME sysid-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "sysid (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_COMPONENT_MPI_DESCRIPTION "Bayesian identification of nonlinear systems, on clusters
What the program sysid loads when mpirun or srun has started it as
several processes: these divide the simulations of a run among them
and give the same bytes as one process.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-sysid)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "sysid (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/cmake/debian/postinst;${CMAKE_SOURCE_DIR}/cmake/debian/prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-xarray, python3-pandas")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Bayesian identification of nonlinear systems, from Python
Models of the language of sysid as functions of NumPy arrays: density,
gradient, residuals and simulations, for samplers and optimisers; and
the tasks of the program, with results as xarray data sets.")

# What every Debian package must hold.
find_program(GZIP_PROGRAM gzip REQUIRED)
configure_file(${CMAKE_SOURCE_DIR}/cmake/debian/changelog.in ${CMAKE_BINARY_DIR}/generated/changelog @ONLY)
execute_process(COMMAND ${GZIP_PROGRAM} -9nkf ${CMAKE_BINARY_DIR}/generated/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${folder} RENAME copyright COMPONENT ${component})
  install(FILES ${CMAKE_BINARY_DIR}/generated/changelog.gz DESTINATION ${folder} COMPONENT ${component})
endforeach()
include(CPack)
