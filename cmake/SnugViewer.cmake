# snug_embed_viewer(target sources...): builds the pages of viewer/ into the build folder and has the sources of `target` embed them.
#
# npm only runs the build here; its packages are fetched by the set-up step (`make setup`), never by configuring or
# building: at most these wait for it. With SNUG_VIEWER off the program is built without the page and says so when it is needed.
option(SNUG_VIEWER "Build the viewer's page into the program; needs node 18 and the packages of viewer/" ON)

# snug_viewer_page(): target snug_viewer_page, which builds the page; SNUG_VIEWER_PAGE in the caller is its file.
function(snug_viewer_page)
  set(viewer ${PROJECT_SOURCE_DIR}/viewer)
  set(page ${PROJECT_BINARY_DIR}/viewer/index.html)
  set(SNUG_VIEWER_PAGE ${page} PARENT_SCOPE)
  if(TARGET snug_viewer_page)
    return()
  endif()
  find_program(SNUG_NPM npm)
  mark_as_advanced(SNUG_NPM)
  # No packages yet is fine while they are being fetched.
  execute_process(COMMAND flock -n -s ${viewer}/package-lock.json true RESULT_VARIABLE is_being_fetched)
  if(NOT SNUG_NPM OR (NOT is_being_fetched AND NOT EXISTS ${viewer}/node_modules))
    message(FATAL_ERROR "The viewer cannot be built: npm or viewer/node_modules is missing. Run `make setup`, "
                        "or configure with -DSNUG_VIEWER=OFF for a program without reports.")
  endif()
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS ${viewer}/src/*)
  file(GLOB settings CONFIGURE_DEPENDS ${viewer}/*.json ${viewer}/*.html ${viewer}/*.ts ${viewer}/*.mjs)
  add_custom_command(OUTPUT ${page}
    BYPRODUCTS ${PROJECT_BINARY_DIR}/viewer/workspace.html ${PROJECT_BINARY_DIR}/viewer/workspace.js ${PROJECT_BINARY_DIR}/viewer/workspace.css
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/build-viewer.sh ${PROJECT_BINARY_DIR}/viewer
    DEPENDS ${inputs} ${settings}
    COMMENT "Building the viewer's page"
    VERBATIM)
  add_custom_target(snug_viewer_page DEPENDS ${page})
endfunction()

function(snug_embed_viewer target)
  add_library(snug_viewer_embedded OBJECT ${ARGN})
  target_include_directories(snug_viewer_embedded PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
  snug_compile_options(snug_viewer_embedded)
  # A compiler cache does not see the page behind the assembler's .incbin: it would bring back an old one.
  set_target_properties(snug_viewer_embedded PROPERTIES CXX_COMPILER_LAUNCHER "")
  target_link_libraries(${target} PRIVATE snug_viewer_embedded)
  if(NOT SNUG_VIEWER)
    return()
  endif()
  snug_viewer_page()
  add_dependencies(snug_viewer_embedded snug_viewer_page)
  set_source_files_properties(${ARGN} PROPERTIES OBJECT_DEPENDS ${SNUG_VIEWER_PAGE}
    COMPILE_DEFINITIONS "SNUG_VIEWER_PAGE=\"${SNUG_VIEWER_PAGE}\";SNUG_WORKSPACE_FOLDER=\"${PROJECT_BINARY_DIR}/viewer\"")
endfunction()
