// off_binary.h - the records of binary OFF files.

#ifndef LS_OFF_BINARY_H
#define LS_OFF_BINARY_H

#include "off_mesh.h"

// Reads what stands behind the first `header_bytes` of the file: the line "OFF BINARY".
LsResult ls_off_read_binary(LsOff* off, uint64_t header_bytes);

#endif
