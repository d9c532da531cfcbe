# The OpenGL 4.5 core function table, generated offline by Debian's python3-glad at build time.
find_program(LAMINA_GLAD glad REQUIRED DOC "glad 2 loader generator (Debian: python3-glad)")
set(LAMINA_GLAD_DIR "${PROJECT_BINARY_DIR}/glad")
add_custom_command(
    OUTPUT "${LAMINA_GLAD_DIR}/include/glad/gl.h"
    COMMAND "${LAMINA_GLAD}" --quiet --api gl:core=4.5 "--extensions=" --reproducible
            --out-path "${LAMINA_GLAD_DIR}" c --header-only --mx
    COMMENT "Generating the OpenGL function table"
    VERBATIM)
add_custom_target(lamina_glad_files DEPENDS "${LAMINA_GLAD_DIR}/include/glad/gl.h")
add_library(lamina_glad INTERFACE)
add_dependencies(lamina_glad lamina_glad_files)
target_include_directories(lamina_glad SYSTEM INTERFACE "${LAMINA_GLAD_DIR}/include")
