# The shader library on a fixture tree: the sources under test with other shaders embedded.
find_package(glm REQUIRED)
include(LaminaShaders)

set(fixtures "${CMAKE_CURRENT_SOURCE_DIR}/shader_fixtures")
set(tree "${CMAKE_CURRENT_BINARY_DIR}/shader_tree")
file(GLOB_RECURSE names CONFIGURE_DEPENDS RELATIVE "${fixtures}/good" "${fixtures}/good/*")
foreach(name IN LISTS names)
    configure_file("${fixtures}/good/${name}" "${tree}/${name}" COPYONLY)
endforeach()

# Beyond what a string literal may hold, and every byte that a text file may hold.
string(REPEAT "// A line of a large source, which makes it larger still.\n" 4000 lines)
set(codes)
foreach(code RANGE 1 255)
    list(APPEND codes ${code})
endforeach()
string(ASCII ${codes} bytes)
file(CONFIGURE OUTPUT "${tree}/lamina/large.glsl" CONTENT "${lines}/*\n${bytes}\n*/\n// end\n" @ONLY)

lamina_add_test(lamina_shader_source_test
    SOURCES
        shader_source_test.cpp
        "${PROJECT_SOURCE_DIR}/src/gl/shader_library.cpp"
        "${PROJECT_SOURCE_DIR}/src/gl/shader_source.cpp"
    LIBRARIES glm::glm
    LABELS unit)
target_include_directories(lamina_shader_source_test PRIVATE "${PROJECT_SOURCE_DIR}/include")
target_compile_definitions(lamina_shader_source_test PRIVATE
    LAMINA_STATIC LAMINA_SHADER_FIXTURES="${fixtures}")
lamina_embed_shaders(lamina_shader_source_test "${tree}")

lamina_add_test(lamina_shader_compiler_test SOURCES shader_compiler_test.cpp LABELS unit)
target_compile_definitions(lamina_shader_compiler_test PRIVATE
    LAMINA_SHADER_FIXTURES="${fixtures}"
    LAMINA_SHADER_COMPILER="$<TARGET_FILE:lamina_shader_compiler>")
add_dependencies(lamina_shader_compiler_test lamina_shader_compiler)
