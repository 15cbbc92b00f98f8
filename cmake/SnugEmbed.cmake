# cmake -DINPUT=FILE -DOUTPUT=HEADER -DNAME=CONSTANT -DNAMESPACE=NAMES -P SnugEmbed.cmake: the bytes of a small file as a constant.
file(READ ${INPUT} bytes HEX)
string(LENGTH "${bytes}" digits)
math(EXPR count "${digits} / 2")
string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "// Made when the project is built: the bytes of one of its files.
#pragma once

#include <array>

namespace ${NAMESPACE} {

inline constexpr std::array<unsigned char, ${count}> ${NAME} = {
${bytes}};

}
")
