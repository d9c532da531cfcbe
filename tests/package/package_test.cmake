# Installs Lamina, moves the installation, and uses it as a stranger would. Run by CTest, see
# CMakeLists.txt here for the variables.
cmake_minimum_required(VERSION 3.25)

# run(<what> <command>...): stops the test with the command's output if it fails; sets `output`.
function(run what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT code EQUAL 0)
        message(FATAL_ERROR "${what} failed (${code}):\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_in_output what text)
    if(NOT output MATCHES "${text}")
        message(FATAL_ERROR "${what}: expected \"${text}\" in:\n${output}")
    endif()
endfunction()

separate_arguments(components UNIX_COMMAND "${COMPONENTS}")
separate_arguments(options UNIX_COMMAND "${OPTIONS}")
set(project_settings -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}"
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE})

# The variant that this build tree is not gets a small build of its own, quick rather than fast.
if(NOT BUILT)
    string(COMPARE EQUAL "${VARIANT}" shared is_shared)
    set(BUILT "${WORK}/build")
    run("configuring Lamina" ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILT} ${project_settings}
        -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=${is_shared} ${options} -DLAMINA_TOOLS=OFF -DLAMINA_EXAMPLES=OFF
        -DLAMINA_TESTS=OFF -DLAMINA_BENCHMARKS=OFF)
    run("building Lamina" ${CMAKE_COMMAND} --build ${BUILT} --parallel 2)
endif()

# Installed in one place, used in another.
set(prefix "${WORK}/moved")
file(REMOVE_RECURSE "${WORK}/prefix" "${prefix}" "${WORK}/runtime" "${WORK}/consumer" "${WORK}/examples" "${WORK}/refused")
run("installing" ${CMAKE_COMMAND} --install ${BUILT} --prefix ${WORK}/prefix)
file(RENAME "${WORK}/prefix" "${prefix}")
file(GLOB_RECURSE installed LIST_DIRECTORIES false "${prefix}/*.cmake" "${prefix}/*.pc" "${prefix}/*.hpp")
foreach(file IN LISTS installed)
    file(READ "${file}" text)
    foreach(place IN ITEMS "${WORK}" "${BUILT}" "${SOURCE}")
        string(FIND "${text}" "${place}" position)
        if(NOT position EQUAL -1)
            message(FATAL_ERROR "${file} names ${place}: the installation cannot be moved")
        endif()
    endforeach()
endforeach()

file(GLOB_RECURSE library_dir "${prefix}/liblamina-core.*")
list(GET library_dir 0 library_dir)
get_filename_component(library_dir "${library_dir}" DIRECTORY)
file(GLOB_RECURSE licence "${prefix}/LICENSE")
if(NOT licence)
    message(FATAL_ERROR "the installation has no LICENSE")
endif()

# The Runtime part: no headers, no link names, no archives.
run("installing Runtime" ${CMAKE_COMMAND} --install ${BUILT} --prefix ${WORK}/runtime --component Runtime)
file(GLOB_RECURSE unwanted "${WORK}/runtime/*.hpp" "${WORK}/runtime/*.so" "${WORK}/runtime/*.a"
    "${WORK}/runtime/*.cmake" "${WORK}/runtime/*.pc" "${WORK}/runtime/*.glsl")
file(GLOB_RECURSE wanted "${WORK}/runtime/liblamina-core.so.*")
if(unwanted OR (VARIANT STREQUAL shared AND NOT wanted))
    message(FATAL_ERROR "install component Runtime: unexpected ${unwanted}; found libraries ${wanted}")
endif()

# No symbol that a host could clash with: of a shared library every exported one lies in lamina,
# of an archive every strong one, but for the two glad loaders under our name.
set(ours "_ZN[KRO]*6lamina|_ZT[VISTC]N6lamina|_ZT[hv].*N6lamina|_ZZN[KRO]*6lamina|_ZGVN6lamina")
foreach(component IN LISTS components)
    if(VARIANT STREQUAL shared)
        run("nm" ${NM} -D --defined-only --format=posix "${library_dir}/liblamina-${component}.so")
        set(kinds "[A-Za-z]")
    else()
        run("nm" ${NM} --defined-only --extern-only --format=posix "${library_dir}/liblamina-${component}.a")
        set(kinds "[A-TX-Z]")
    endif()
    string(REPLACE "\n" ";" lines "${output}")
    list(FILTER lines INCLUDE REGEX "^[^ ]+ ${kinds} ")
    list(LENGTH lines count)
    if(count LESS 3)
        message(FATAL_ERROR "nm found ${count} symbols in liblamina-${component}")
    endif()
    list(FILTER lines EXCLUDE REGEX "^(${ours})")
    list(FILTER lines EXCLUDE REGEX "^laminaGladLoadContext(UserPtr)? ")
    if(lines)
        message(FATAL_ERROR "liblamina-${component} exports symbols outside of namespace lamina: ${lines}")
    endif()
endforeach()

# find_package: a host with a context and buffers of its own, and a program for every component.
run("configuring the consumer" ${CMAKE_COMMAND} -S ${SOURCE}/tests/package/consumer -B ${WORK}/consumer
    ${project_settings} "-DCMAKE_PREFIX_PATH=${prefix}" "-DWANTED=${COMPONENTS}" -DWANTED_VERSION=${VERSION})
run("building the consumer" ${CMAKE_COMMAND} --build ${WORK}/consumer --parallel 2)
run("the host program" ${WORK}/consumer/host_program)
expect_in_output("the host program" "32 voxels")
run("the component program" ${WORK}/consumer/component_program)
if("transmittance" IN_LIST components)
    run("the transmittance program" ${WORK}/consumer/transmittance_program)
endif()

# The examples are a project of their own too.
if(EXAMPLES)
    run("configuring the examples" ${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${WORK}/examples
        ${project_settings} "-DCMAKE_PREFIX_PATH=${prefix}")
    run("building the examples" ${CMAKE_COMMAND} --build ${WORK}/examples --parallel 2)
endif()

# pkg-config and a plain compiler line.
set(ENV{PKG_CONFIG_PATH} "${library_dir}/pkgconfig")
run("pkg-config" ${PKG_CONFIG} --cflags --libs lamina-core egl)
separate_arguments(pkg_config_flags UNIX_COMMAND "${output}")
run("pkg-config" ${PKG_CONFIG} --variable=shaderdir lamina-core)
string(STRIP "${output}" shader_dir)
separate_arguments(host_flags UNIX_COMMAND "${FLAGS}")
run("compiling with pkg-config" ${COMPILER} ${host_flags} -std=c++20 "-DHOST_SHADER_DIR=\"${shader_dir}\""
    ${SOURCE}/tests/package/consumer/host_program.cpp -o ${WORK}/pkg_config_program ${pkg_config_flags})
run("the pkg-config program" ${CMAKE_COMMAND} -E env "LD_LIBRARY_PATH=${library_dir}" ${WORK}/pkg_config_program)
expect_in_output("the pkg-config program" "32 voxels")
foreach(component IN LISTS components)
    run("pkg-config" ${PKG_CONFIG} --cflags --libs lamina-${component})
endforeach()

# Refusals name what is wrong.
foreach(case IN ITEMS
        "0.1 COMPONENTS core no_such_part|lamina: component no_such_part was not built in this installation"
        "9.9 COMPONENTS core|compatible with requested version \"9.9\""
        "0.0 COMPONENTS core|compatible with requested version \"0.0\"")
    string(REPLACE "|" ";" case "${case}")
    list(GET case 0 request)
    list(GET case 1 expected)
    file(REMOVE_RECURSE "${WORK}/refused")
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/package/refused -B ${WORK}/refused
            ${project_settings} "-DCMAKE_PREFIX_PATH=${prefix}" "-DREQUEST=${request}"
        RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(code EQUAL 0)
        message(FATAL_ERROR "find_package(lamina ${request}) succeeded")
    endif()
    string(REGEX REPLACE "[ \n]+" " " output "${output}")
    expect_in_output("find_package(lamina ${request})" "${expected}")
endforeach()

# The installed tool finds the libraries beside it.
if(EXISTS "${prefix}/bin/lamina-voxelize")
    run("lamina-voxelize --help" "${prefix}/bin/lamina-voxelize" --help)
    expect_in_output("lamina-voxelize --help" "--resolution")
endif()
