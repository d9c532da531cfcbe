# Settings every target shares, and lamina_add_library(), which declares one library component.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Build type" FORCE)
endif()
find_program(LAMINA_CCACHE ccache)
if(LAMINA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${LAMINA_CCACHE}")
endif()

# Tests and tools run from the build tree without an install step.
if(PROJECT_IS_TOP_LEVEL)
    set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
    set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
    set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
    set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()

set(LAMINA_ABI_VERSION 0)
set(LAMINA_COMPONENTS "" CACHE INTERNAL "Library components of this build")

# What every target of the project compiles with; never exported.
add_library(lamina_flags INTERFACE)
target_compile_features(lamina_flags INTERFACE cxx_std_20)
target_compile_options(lamina_flags INTERFACE -Wall -Wextra -Wpedantic $<$<BOOL:${LAMINA_WERROR}>:-Werror>)
# Geometry must not depend on whether the compiler found a fused multiply-add.
target_compile_options(lamina_flags INTERFACE -ffp-contract=off)
if(LAMINA_SANITIZE)
    target_compile_options(lamina_flags INTERFACE -fsanitize=${LAMINA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(lamina_flags INTERFACE -fsanitize=${LAMINA_SANITIZE})
endif()
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_CXX_EXTENSIONS OFF)

# lamina_add_library(<component> SOURCES <files> [PUBLIC_LIBRARIES <targets>] [PRIVATE_LIBRARIES <targets>])
# Declares lamina_<component>, alias lamina::<component>, and registers it for installation.
function(lamina_add_library component)
    cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC_LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
    set(target lamina_${component})
    add_library(${target} ${arg_SOURCES})
    add_library(lamina::${component} ALIAS ${target})
    set_target_properties(${target} PROPERTIES
        EXPORT_NAME ${component}
        OUTPUT_NAME lamina-${component}
        VERSION ${PROJECT_VERSION}
        SOVERSION ${LAMINA_ABI_VERSION})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target}
        PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
               "$<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>"
               "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
        PRIVATE "${PROJECT_SOURCE_DIR}/src" "${PROJECT_SOURCE_DIR}/shaders")
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC_LIBRARIES}
        PRIVATE $<BUILD_INTERFACE:lamina_flags> ${arg_PRIVATE_LIBRARIES})
    if(BUILD_SHARED_LIBS)
        set(exports "${PROJECT_SOURCE_DIR}/cmake/lamina.map")
        target_link_options(${target} PRIVATE "LINKER:--version-script=${exports}")
        set_target_properties(${target} PROPERTIES LINK_DEPENDS "${exports}")
    else()
        target_compile_definitions(${target} PUBLIC LAMINA_STATIC)
    endif()
    set(LAMINA_COMPONENTS ${LAMINA_COMPONENTS} ${component} CACHE INTERNAL "")
endfunction()
