# The wheel: what `pip wheel .` packs (pyproject.toml), component `python` of the installation. scikit-build-core configures with SKBUILD set and names
# its interpreter; pybind11 is PyPI's, since that of Debian 12 knows no numpy 2. Target snug_wheel makes all of it. The build folder may be one
# that a preset made: the libraries and the program are the same.
#
#   snug/                      the package, with _core, its stubs and page.html
#   snug/bin/snug              the program; it finds share/snug beside its folder, as where it is installed
#   snug/share/snug/           scenarios, and python/snug/agent.py for agents that the program runs
#   _snug_program.py           the command `snug`
execute_process(COMMAND ${Python_EXECUTABLE} -c "import sysconfig, pybind11; print(sysconfig.get_paths()['include'], sysconfig.get_config_var('EXT_SUFFIX'), pybind11.get_include(), sep=';')"
  OUTPUT_VARIABLE wheel RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(failed)
  return()  # an interpreter of an isolated build that is gone
endif()
list(GET wheel 0 wheel_include)
list(GET wheel 1 wheel_suffix)
list(GET wheel 2 wheel_pybind11)
if(NOT EXISTS ${wheel_include}/Python.h)
  message(FATAL_ERROR "No Python.h in ${wheel_include}: the wheel needs the headers of ${Python_EXECUTABLE} (Debian: python3-dev)")
endif()
snug_python_extension(snug_wheel_core FOLDER ${PROJECT_BINARY_DIR}/wheel-core SUFFIX ${wheel_suffix} INCLUDES ${wheel_include} ${wheel_pybind11})
add_custom_target(snug_wheel DEPENDS snug_wheel_core snug)

install(TARGETS snug_wheel_core LIBRARY DESTINATION snug COMPONENT python EXCLUDE_FROM_ALL)
install(PROGRAMS $<TARGET_FILE:snug> DESTINATION snug/bin COMPONENT python EXCLUDE_FROM_ALL)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenarios DESTINATION snug/share/snug COMPONENT python EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/python/snug/agent.py DESTINATION snug/share/snug/python/snug COMPONENT python EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/python/_snug_program.py DESTINATION . COMPONENT python EXCLUDE_FROM_ALL)
if(SNUG_VIEWER)
  snug_viewer_page()
  add_dependencies(snug_wheel snug_viewer_page)
  install(FILES ${SNUG_VIEWER_PAGE} RENAME page.html DESTINATION snug COMPONENT python EXCLUDE_FROM_ALL)
endif()
