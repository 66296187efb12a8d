# Eigen as it computes on x86-64 with SSE2, for AArch64. For NEON it fuses multiplications with additions and, for that, cuts products
# of matrices into other blocks, so sums are rounded otherwise. No macro turns this off: a copy of the headers has it removed.
get_target_property(eigen_headers Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(eigen_copy ${CMAKE_BINARY_DIR}/eigen)

# sysid_edit_eigen(FILE BEFORE AFTER): in every place of the copy. A version of Eigen that has none must be looked at first.
function(sysid_edit_eigen file before after)
  set(path ${eigen_copy}/Eigen/src/Core/arch/NEON/${file})
  file(READ ${path} text)
  string(FIND "${text}" "${before}" where)
  if(where EQUAL -1)
    message(FATAL_ERROR "${file} of this Eigen has no `${before}`: cmake/eigen_aarch64.cmake is written for Eigen 3.4.0")
  endif()
  string(REPLACE "${before}" "${after}" text "${text}")
  file(WRITE ${path} "${text}")
endfunction()

if(NOT EXISTS ${eigen_copy}/edited)
  file(COPY ${eigen_headers}/Eigen DESTINATION ${eigen_copy})
  sysid_edit_eigen(PacketMath.h "#define EIGEN_HAS_SINGLE_INSTRUCTION_MADD" "")
  sysid_edit_eigen(PacketMath.h "#ifdef __ARM_FEATURE_FMA" "#if 0")
  sysid_edit_eigen(GeneralBlockPanelKernel.h "#if EIGEN_ARCH_ARM64" "#if 0")
  file(TOUCH ${eigen_copy}/edited)
endif()
set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${eigen_copy})
