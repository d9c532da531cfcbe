# Compares the README's C++ block with the lines of engine_snippet.cpp between "README begin" and
# "README end". Variables: README, SNIPPET.
cmake_minimum_required(VERSION 3.25)

# text_between(<file> <begin> <end> <variable>): the lines after the line `begin` and before `end`.
function(text_between file begin end variable)
    file(READ "${file}" text)
    string(FIND "${text}" "${begin}" from)
    if(from EQUAL -1)
        message(FATAL_ERROR "${file}: expected \"${begin}\", found none")
    endif()
    string(LENGTH "${begin}" length)
    math(EXPR from "${from} + ${length}")
    string(SUBSTRING "${text}" ${from} -1 text)
    string(FIND "${text}" "${end}" to)
    if(to LESS_EQUAL 0)
        message(FATAL_ERROR "${file}: expected lines and \"${end}\" after \"${begin}\", found none")
    endif()
    string(SUBSTRING "${text}" 0 ${to} text)
    set(${variable} "${text}" PARENT_SCOPE)
endfunction()

text_between("${README}" "```cpp\n" "```\n" shown)
text_between("${SNIPPET}" "    // README begin\n" "    // README end\n" compiled)
string(REPLACE "\n    " "\n" compiled "\n${compiled}")
if(NOT "\n${shown}" STREQUAL compiled)
    message(NOTICE "engine_snippet.cpp compiles:${compiled}")
    message(FATAL_ERROR "README.md shows other C++ than engine_snippet.cpp compiles, see above")
endif()
