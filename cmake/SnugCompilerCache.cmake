# ccache is used when found, unless another launcher is asked for.
#
# sloppiness: ccache refuses precompiled headers unless told that macros and time stamps of what they hold are of no concern.
# depend: the compiler's own list of what a file includes is what is compared, instead of a run of the preprocessor before each
# compilation; on a machine with an empty cache that is a tenth of the time of a build.
if(NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SNUG_CCACHE ccache)
  mark_as_advanced(SNUG_CCACHE)
  if(SNUG_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${SNUG_CCACHE})
  endif()
endif()
