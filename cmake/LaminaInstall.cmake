# Installation of every component in LAMINA_COMPONENTS: library, headers, shaders, CMake package,
# pkg-config files, licence. Two install components: Runtime (what a finished program needs) and
# Development (what building against Lamina needs).
include(CMakePackageConfigHelpers)

set(lamina_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/lamina")
set(lamina_shader_dir "${CMAKE_INSTALL_DATADIR}/lamina/shaders")
file(RELATIVE_PATH lamina_prefix_from_pc "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" lamina_prefix_from_pc "${lamina_prefix_from_pc}")

# What a component may link: target or library, CMake package, pkg-config module or linker flag.
set(lamina_externals
    "glm::glm|glm|glm"
    "OpenMeshCore|OpenMesh|openmesh"
    "PNG::PNG|PNG|libpng"
    "ZLIB::ZLIB|ZLIB|zlib"
    "TBB::tbb|TBB|tbb"
    "Imath::Imath|Imath|Imath"
    "Threads::Threads|Threads|-pthread"
    "dl||-ldl")

# lamina_needs(<component> <prefix>): what users of the installed component need with it: its public
# dependencies and, for a static library, the private ones. Sets <prefix>_COMPONENTS, <prefix>_PACKAGES,
# <prefix>_MODULES (pkg-config) and <prefix>_FLAGS (linker) in the caller.
function(lamina_needs component prefix)
    set(components)
    set(packages)
    set(modules)
    set(flags)
    get_target_property(links lamina_${component} INTERFACE_LINK_LIBRARIES)
    foreach(link IN LISTS links)
        string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" link "${link}")
        if(link MATCHES "^\\$<BUILD_INTERFACE:" OR link STREQUAL "")
            continue()
        endif()
        if(link MATCHES "^lamina::(.*)$")
            list(APPEND components "${CMAKE_MATCH_1}")
            continue()
        endif()
        if(IS_ABSOLUTE "${link}")
            get_filename_component(name "${link}" NAME_WE)
            string(REGEX REPLACE "^lib" "-l" flag "${name}")
            list(APPEND flags "${flag}")
            continue()
        endif()
        set(external "${lamina_externals}")
        list(FILTER external INCLUDE REGEX "^${link}\\|")
        if(NOT external)
            message(FATAL_ERROR "lamina_${component} links ${link}: name its package in lamina_externals")
        endif()
        string(REPLACE "|" ";" external "${external}")
        list(GET external 1 package)
        list(GET external 2 module)
        list(APPEND packages ${package})
        if(module MATCHES "^-")
            list(APPEND flags "${module}")
        else()
            list(APPEND modules "${module}")
        endif()
    endforeach()
    foreach(kind IN ITEMS components packages modules flags)
        string(TOUPPER "${kind}" name)
        set(${prefix}_${name} ${${kind}} PARENT_SCOPE)
    endforeach()
endfunction()

# lamina_write_pkg_config(<component>): lamina-<component>.pc in the build tree; reads need_*. An
# installation has one kind of library, so users of a static one need no --static.
function(lamina_write_pkg_config component)
    set(requires ${need_MODULES})
    foreach(other IN LISTS need_COMPONENTS)
        list(APPEND requires "lamina-${other} = ${PROJECT_VERSION}")
    endforeach()
    list(JOIN requires ", " requires)
    list(JOIN need_FLAGS " " flags)
    get_target_property(definitions lamina_${component} INTERFACE_COMPILE_DEFINITIONS)
    set(definition_flags)
    if(definitions)
        list(TRANSFORM definitions PREPEND "-D" OUTPUT_VARIABLE definition_flags)
        list(JOIN definition_flags " " definition_flags)
    endif()
    configure_file("${PROJECT_SOURCE_DIR}/cmake/lamina.pc.in"
                   "${PROJECT_BINARY_DIR}/package/lamina-${component}.pc" @ONLY)
endfunction()

foreach(component IN LISTS LAMINA_COMPONENTS)
    set_target_properties(lamina_${component} PROPERTIES INSTALL_RPATH "$ORIGIN")
    install(TARGETS lamina_${component} EXPORT lamina_${component}
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT Runtime NAMELINK_COMPONENT Development
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT Development)
    install(EXPORT lamina_${component} FILE lamina-${component}-targets.cmake NAMESPACE lamina::
        DESTINATION "${lamina_package_dir}" COMPONENT Development)

    lamina_needs(${component} need)
    configure_file("${PROJECT_SOURCE_DIR}/cmake/laminaComponent.cmake.in"
                   "${PROJECT_BINARY_DIR}/package/lamina-${component}.cmake" @ONLY)
    lamina_write_pkg_config(${component})
    install(FILES "${PROJECT_BINARY_DIR}/package/lamina-${component}.cmake"
        DESTINATION "${lamina_package_dir}" COMPONENT Development)
    install(FILES "${PROJECT_BINARY_DIR}/package/lamina-${component}.pc"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT Development)
endforeach()

set(lamina_header_folders gl grid voxelize ${LAMINA_COMPONENTS})
foreach(folder IN LISTS lamina_header_folders)
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/lamina/${folder}"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamina" COMPONENT Development FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/include/lamina/core/version.hpp"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamina/core" COMPONENT Development)
# What engines include; the entry points beside it are embedded in the library.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/shaders/lamina"
    DESTINATION "${lamina_shader_dir}" COMPONENT Development FILES_MATCHING PATTERN "*.glsl")

configure_package_config_file(cmake/laminaConfig.cmake.in "${PROJECT_BINARY_DIR}/package/laminaConfig.cmake"
    INSTALL_DESTINATION "${lamina_package_dir}" PATH_VARS lamina_shader_dir NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a new minor version may change the API; a patch may not.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/package/laminaConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/package/laminaConfig.cmake"
              "${PROJECT_BINARY_DIR}/package/laminaConfigVersion.cmake"
    DESTINATION "${lamina_package_dir}" COMPONENT Development)

install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT Runtime)
