# What `cmake --install` and `cpack` put where: component `program` (program, scenarios, manual, completion in shells) and
# component `development` (headers, libraries, what find_package(snug) reads, examples). All of it may be moved elsewhere.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(SNUG_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/snug)

# Each module is an export of its own, so that a project needs only the packages of the modules it asks for.
get_property(SNUG_INSTALLED_MODULES GLOBAL PROPERTY snug_modules)
set(SNUG_MODULE_TABLE "")
foreach(module IN LISTS SNUG_INSTALLED_MODULES)
  get_property(needs GLOBAL PROPERTY snug_needs_${module})
  get_property(links GLOBAL PROPERTY snug_links_${module})
  string(APPEND SNUG_MODULE_TABLE
    "set(snug_module_${module}_needs \"${needs}\")\nset(snug_module_${module}_links \"${links}\")\n")
  set_target_properties(snug_${module} PROPERTIES EXPORT_NAME ${module})
  install(TARGETS snug_${module} EXPORT snug-${module}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  install(EXPORT snug-${module} NAMESPACE snug:: DESTINATION ${SNUG_CMAKE_DIR} COMPONENT development)
endforeach()
configure_package_config_file(cmake/snugConfig.cmake.in ${PROJECT_BINARY_DIR}/snugConfig.cmake
  INSTALL_DESTINATION ${SNUG_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/snugConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/snugConfig.cmake ${PROJECT_BINARY_DIR}/snugConfigVersion.cmake
    cmake/SnugDependencies.cmake
  DESTINATION ${SNUG_CMAKE_DIR} COMPONENT development)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/snug COMPONENT development)

if(SNUG_PROGRAM)
  set(made ${PROJECT_BINARY_DIR}/made)  # by the program itself, so that no word of it can be out of date
  add_custom_command(OUTPUT ${made}/snug.1 ${made}/snug.bash ${made}/_snug ${made}/snug.fish
    COMMAND ${CMAKE_COMMAND} -E make_directory ${made}
    COMMAND snug manual > ${made}/snug.1
    COMMAND snug completion bash > ${made}/snug.bash
    COMMAND snug completion zsh > ${made}/_snug
    COMMAND snug completion fish > ${made}/snug.fish
    DEPENDS snug
    COMMENT "Writing the manual and the completion of words in shells"
    VERBATIM)
  add_custom_target(snug_manual ALL DEPENDS ${made}/snug.1)
  install(TARGETS snug RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(FILES python/snug/agent.py DESTINATION ${CMAKE_INSTALL_DATADIR}/snug/python/snug COMPONENT program)
  install(DIRECTORY scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/snug COMPONENT program)
  install(FILES ${made}/snug.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${made}/snug.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME snug
    COMPONENT program)
  install(FILES ${made}/_snug DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
  install(FILES ${made}/snug.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
  install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)
endif()

# cpack -G DEB: snug and libsnug-dev.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The snug project <snug@invalid>")
set(CPACK_PACKAGE_HOMEPAGE_URL "")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME snug)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS chromium)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "simulates, plans and measures how a robot with a suction cup packs boxes")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libsnug-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libexpected-dev")
# What the modules link; a project that uses few of them needs few.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libfmt-dev, libyaml-cpp-dev, nlohmann-json3-dev, libhdf5-dev, zlib1g-dev, \
libzstd-dev, libcpp-httplib-dev, libssl-dev, libtinyxml2-dev, libassimp-dev, libceres-dev, libnlopt-cxx-dev, \
libzmq3-dev, libprotobuf-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "snug's contact physics, suction cup, packing and robot cell as C++ libraries")
include(CPack)
