# The Python module: a compiled part, which has the whole engine in it, and what users call, in Python. As built it can be imported
# with PYTHONPATH=build/test/python.

# Debian's Python, whatever stands before it on the path.
set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "the interpreter that the module is for")
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
set(PYBIND11_NOPYTHON ON)  # it would look for an interpreter of its own
find_package(pybind11 REQUIRED CONFIG)

file(GLOB python_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/python/*.cpp)
sysid_fast_objects(fast_objects sysid_exchange sysid_embed sysid_assist)
add_library(sysid_python MODULE ${fast_objects} ${python_sources})
set_target_properties(sysid_python PROPERTIES OUTPUT_NAME _engine PREFIX "" SUFFIX .${Python3_SOABI}.so UNITY_BUILD OFF
                                              CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                              LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/python/sysid)
target_link_libraries(sysid_python PRIVATE sysid_exchange sysid_embed sysid_assist pybind11::headers Python3::Module)
target_link_options(sysid_python PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections)
sysid_compile_lightly(sysid_python)

# What is written in Python goes beside it.
file(GLOB python_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/python/sysid/*)
list(FILTER python_files EXCLUDE REGEX "__pycache__")
foreach(file IN LISTS python_files)
  get_filename_component(name ${file} NAME)
  configure_file(${file} ${CMAKE_BINARY_DIR}/python/sysid/${name} COPYONLY)
endforeach()

set(SYSID_PYTHON_FOLDER lib/python3/dist-packages CACHE STRING "where the Python module is installed")
sysid_finds_modules(sysid_python ${SYSID_PYTHON_FOLDER}/sysid $ORIGIN $ORIGIN/../..)  # in a wheel they lie beside
install(TARGETS sysid_python LIBRARY DESTINATION ${SYSID_PYTHON_FOLDER}/sysid COMPONENT python)
install(FILES ${python_files} DESTINATION ${SYSID_PYTHON_FOLDER}/sysid COMPONENT python)

# `cmake --build build/release --target wheel`: the same files as a wheel in build/release/wheel, by Python alone and without a network.
set(wheel ${CMAKE_BINARY_DIR}/wheel)
set(modules sysid_records_module)
if(TARGET sysid_native_module)
  list(APPEND modules sysid_native_module)
endif()
set(module_files)
foreach(module IN LISTS modules)
  list(APPEND module_files $<TARGET_FILE:${module}>)
endforeach()
add_custom_target(wheel
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${wheel}
  COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --component python --strip --prefix ${wheel}/installed > ${CMAKE_BINARY_DIR}/wheel.log
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/cmake/wheel.py ${wheel}/installed/${SYSID_PYTHON_FOLDER} ${PROJECT_VERSION}
          ${CMAKE_SOURCE_DIR}/LICENSE ${wheel} ${module_files}
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${wheel}/installed
  VERBATIM)
add_dependencies(wheel sysid_python ${modules})
