# ccache is used when found, unless another launcher is asked for.
#
# sloppiness: ccache refuses precompiled headers unless told that macros of what they hold are of no concern. Time stamps are of
# concern: a header edited while it is compiled must not become an entry of the cache.
# depend: the compiler's own list of what a file includes is what is compared, instead of a run of the preprocessor before each
# compilation; on a machine with an empty cache that is a tenth of the time of a build.
if(NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SNUG_CCACHE ccache)
  mark_as_advanced(SNUG_CCACHE)
  if(SNUG_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${SNUG_CCACHE})
  endif()
endif()
