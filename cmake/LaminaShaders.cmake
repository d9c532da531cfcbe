# lamina_embed_shaders(<target> <root>)
# Compiles and links the shaders under <root> at build time (an error in one stops the build and
# names its file and line) and adds their sources to <target>, which must also compile
# src/gl/shader_library.cpp. New, changed and removed shaders are noticed by the next build.
function(lamina_embed_shaders target root)
    set(patterns)
    foreach(extension glsl vert tesc tese geom frag comp)
        list(APPEND patterns "${root}/*.${extension}")
    endforeach()
    file(GLOB_RECURSE shaders CONFIGURE_DEPENDS ${patterns})
    file(GLOB programs CONFIGURE_DEPENDS "${root}/programs.txt")

    set(output "${CMAKE_CURRENT_BINARY_DIR}/${target}_shaders.cpp")
    add_custom_command(
        OUTPUT "${output}"
        COMMAND lamina_shader_compiler --root "${root}" --output "${output}" --depfile "${output}.d"
        DEPENDS lamina_shader_compiler ${shaders} ${programs}
        DEPFILE "${output}.d"
        COMMENT "Compiling and embedding the shaders of ${target}"
        VERBATIM)
    target_sources(${target} PRIVATE "${output}")
endfunction()
