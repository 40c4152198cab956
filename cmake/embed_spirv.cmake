# Script: writes the words of the SPIR-V file SPIRV as the C array NAME into HEADER; SOURCE is named
# in it. SPIR-V is a stream of 32-bit words in the byte order of the machine that compiled it; ours
# is little-endian.
file(READ ${SPIRV} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
string(REPEAT "..........," 8 line)
string(REGEX REPLACE "(${line})" "    \\1\n" words "${words}")
file(WRITE ${HEADER} "// Made from ${SOURCE} by the build.\n#include <stdint.h>\n\n"
    "static const uint32_t ${NAME}[] = {\n${words}\n};\n")
